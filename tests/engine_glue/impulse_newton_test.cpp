// The impulses of a step solved at once, against what statics says they are.
#include "stack/impulse_newton.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>

#include "stack/body_inertia.hpp"

namespace pd::test {
namespace {

using detail::body_inertia;
using detail::BodyInertia;
using detail::ImpulseNewton;
using Row = ImpulseNewton::Row;

/// A row of the relative velocity of `upper` against `lower` (-1: fixed), which falls by `fall` in a step.
Row supports(int lower, int upper, double fall, const Eigen::Vector3d& lever = Eigen::Vector3d::Zero()) {
  Row row;
  row.body[0] = upper;
  row.body[1] = lower;
  const Eigen::Vector3d up = Eigen::Vector3d::UnitY();
  row.jacobian[0] << up, lever.cross(up);
  row.jacobian[1] << -up, -lever.cross(up);
  row.target = lower < 0 ? fall : 0;
  row.softness = row.of_changes = 1e-4;
  row.upper = 1e10;
  return row;
}

/// A row of the velocity along x of `body`, held by what `normal` carries.
Row rubs(int body, int normal, double friction, double target) {
  Row row;
  row.body[0] = body;
  row.jacobian[0] << 1, 0, 0, 0, 0, 0;
  row.target = target;
  row.softness = 1e-6;
  row.normal = normal;
  row.friction = friction;
  return row;
}

TEST(BodyInertia, MassTimesInverseIsTheIdentity) {
  const btMatrix3x3 turned(btQuaternion(btVector3(1, 2, 3).normalized(), btScalar(0.7)));
  const btMatrix3x3 inverse = turned.scaled(btVector3(1, 4, btScalar(0.25))) * turned.transpose();
  for (const btVector3& angular : {btVector3(1, 1, 1), btVector3(1, 0, 1), btVector3(0, 0, 0)}) {
    for (const btVector3& linear : {btVector3(2, 2, 2), btVector3(2, 0, 2)}) {
      const BodyInertia body = body_inertia(linear, inverse, angular);
      EXPECT_TRUE((body.mass * body.inverse).isIdentity(1e-12));
      EXPECT_EQ(body.moves[1] > 0, linear.y() > 0);
      EXPECT_EQ(body.moves[4] > 0, angular.y() > 0);
    }
  }
}

TEST(ImpulseNewton, EveryContactOfATowerCarriesWhatIsAbove) {
  constexpr int kBodies = 40;
  constexpr double kFall = 0.16;
  ImpulseNewton newton;
  newton.masses.assign(kBodies, ImpulseNewton::Matrix6::Identity());
  for (int i = 0; i < kBodies; ++i) {
    // Four points a face: more rows than a body has ways to move.
    for (const double x : {-0.5, 0.5}) {
      for (const double z : {-0.5, 0.5}) newton.rows.push_back(supports(i - 1, i, kFall, {x, -0.5, z}));
    }
  }
  const ImpulseNewton::Outcome outcome = newton.solve();
  EXPECT_TRUE(outcome.settled);
  EXPECT_LE(outcome.factorisations, 3);
  for (int i = 0; i < kBodies; ++i) {
    double carried = 0;
    for (int k = 0; k < 4; ++k) carried += newton.rows[static_cast<std::size_t>(4 * i + k)].impulse;
    EXPECT_NEAR(carried, (kBodies - i) * kFall, 1e-3 * kBodies * kFall) << i;
    EXPECT_NEAR(newton.rows[static_cast<std::size_t>(4 * i)].impulse, carried / 4, 1e-6 * carried);
  }
  // And from there again: what holds is known.
  EXPECT_EQ(newton.solve().factorisations, 1);
}

TEST(ImpulseNewton, AContactPushesOnly) {
  ImpulseNewton newton;
  newton.masses.assign(1, ImpulseNewton::Matrix6::Identity());
  newton.rows.push_back(supports(-1, 0, -0.3));  // it rises
  newton.rows.back().impulse = 2;                // and was held before
  EXPECT_TRUE(newton.solve().settled);
  EXPECT_EQ(newton.rows[0].impulse, 0);
}

TEST(ImpulseNewton, FrictionHoldsUpToItsShareOfTheNormalImpulse) {
  for (const double slide : {0.05, 0.3}) {
    ImpulseNewton newton;
    newton.masses.assign(1, ImpulseNewton::Matrix6::Identity());
    newton.rows.push_back(supports(-1, 0, 0.16));
    newton.rows.push_back(rubs(0, 0, 0.5, -slide));
    EXPECT_TRUE(newton.solve().settled);
    EXPECT_NEAR(newton.rows[0].impulse, 0.16, 1e-5);
    EXPECT_NEAR(newton.rows[1].impulse, -std::min(slide, 0.08), 1e-5) << slide;
  }
}

/// The equations themselves, on random heaps: impulses within their bounds, and as far from them as velocities say.
TEST(ImpulseNewton, RandomHeapsSettleAndObeyTheEquations) {
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0, 1);
  int factorisations = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const int bodies = 1 + static_cast<int>(random() % 12);
    ImpulseNewton newton;
    for (int i = 0; i < bodies; ++i) {
      ImpulseNewton::Matrix6 factor;
      for (double& each : factor.reshaped()) each = normal(random);
      newton.masses.emplace_back(ImpulseNewton::Matrix6::Identity() + 0.1 * factor * factor.transpose());
    }
    const int contacts = 1 + static_cast<int>(random() % 30);
    for (int i = 0; i < contacts; ++i) {
      Row row;
      row.body[0] = static_cast<int>(random() % static_cast<unsigned>(bodies));
      row.body[1] = static_cast<int>(random() % static_cast<unsigned>(bodies + 1)) - 1;
      if (row.body[1] == row.body[0]) row.body[1] = -1;
      for (ImpulseNewton::Vector6& jacobian : row.jacobian) {
        for (double& each : jacobian) each = normal(random);
      }
      row.target = normal(random);
      row.softness = 1e-4;
      row.upper = 1e10;
      row.impulse = uniform(random) < 0.5 ? 0 : uniform(random);
      newton.rows.push_back(row);
      row.normal = static_cast<int>(newton.rows.size()) - 1;
      row.friction = 0.4 * uniform(random);
      row.impulse = 0;
      for (ImpulseNewton::Vector6& jacobian : row.jacobian) {
        for (double& each : jacobian) each = normal(random);
      }
      newton.rows.push_back(row);
    }
    const ImpulseNewton::Outcome outcome = newton.solve();
    factorisations += outcome.factorisations;
    ASSERT_TRUE(outcome.settled) << trial;
    Eigen::VectorXd momentum = Eigen::VectorXd::Zero(6 * bodies);
    for (const Row& row : newton.rows) {
      for (int side = 0; side < 2; ++side) {
        if (row.body[side] >= 0) momentum.segment<6>(6 * row.body[side]) += row.impulse * row.jacobian[side];
      }
    }
    double largest = 0;
    for (const Row& row : newton.rows) largest = std::max(largest, std::abs(row.impulse));
    for (const Row& row : newton.rows) {
      double speed = 0;
      for (int side = 0; side < 2; ++side) {
        if (row.body[side] < 0) continue;
        const auto body = static_cast<std::size_t>(row.body[side]);
        speed += row.jacobian[side].dot(newton.masses[body].llt().solve(momentum.segment<6>(6 * row.body[side])));
      }
      const double free = (row.target - speed) / row.softness;
      if (row.normal < 0) {
        EXPECT_NEAR(row.impulse, std::max(0.0, free), 1e-4 * largest) << trial;
      } else if (std::abs(row.impulse - free) > 1e-4 * largest) {
        // Held: as far as it may, the way it would.
        EXPECT_GE(row.impulse * free, 0) << trial;
        EXPECT_LT(std::abs(row.impulse), std::abs(free)) << trial;
      }
    }
  }
  EXPECT_LT(factorisations, 200 * 12);
}

}  // namespace
}  // namespace pd::test
