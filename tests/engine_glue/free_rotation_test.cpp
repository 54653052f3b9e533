// The turning of a body without torque: what it keeps, and the case that has a closed form.
#include "rollback/free_rotation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace pd::test {
namespace {

double energy(const detail::Rotation& rotation, const Vec3& inertia) {
  const Vec3 spin = rotation.orientation.transpose() * rotation.angular_velocity;
  return 0.5 * spin.cwiseProduct(inertia).dot(spin);
}

Vec3 momentum(const detail::Rotation& rotation, const Vec3& inertia) {
  return rotation.orientation *
         Vec3((rotation.orientation.transpose() * rotation.angular_velocity).cwiseProduct(inertia));
}

TEST(FreeRotation, KeepsEnergyAndMomentum) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> moment(0.2, 1);
  const auto vector = [&] {
    const double x = normal(random);
    const double y = normal(random);
    const double z = normal(random);
    return Vec3(x, y, z);
  };
  for (int i = 0; i < 200; ++i) {
    // Of a solid body: no moment is above the sum of the others.
    const Vec3 squares{moment(random), moment(random), moment(random)};
    const Vec3 inertia(squares.y() + squares.z(), squares.z() + squares.x(), squares.x() + squares.y());
    const Vec3 axis = vector().normalized();
    const Eigen::AngleAxisd turn(3 * normal(random), axis);
    detail::Rotation rotation{turn.toRotationMatrix(), 10 * vector()};
    const double before = energy(rotation, inertia);
    const Vec3 whole = momentum(rotation, inertia);
    for (int k = 0; k < 60; ++k) {
      rotation = detail::rotate_freely(rotation, inertia, 1.0 / 60);
      ASSERT_NEAR(energy(rotation, inertia), before, 5e-7 * before) << i;
      ASSERT_LE((momentum(rotation, inertia) - whole).norm(), 1e-12 * whole.norm())
          << i;  // some 50,000 turns, each rounded
    }
  }
}

// A body with two equal moments turns about its axis, and its axis about the momentum: both at constant rates.
TEST(FreeRotation, ASymmetricTopPrecesses) {
  const Vec3 inertia(2, 2, 1);
  const Vec3 spin(0.3, 0, 4);
  detail::Rotation rotation{Mat3::Identity(), spin};
  const Vec3 whole = spin.cwiseProduct(inertia);
  for (int i = 0; i < 60; ++i) rotation = detail::rotate_freely(rotation, inertia, 1.0 / 60);
  // The angular velocity is L / 2 and the rest along the axis.
  const double rate = spin.z() - whole.z() / inertia.x();
  const Mat3 known = Eigen::AngleAxisd(whole.norm() / inertia.x(), whole.normalized()).toRotationMatrix() *
                     Eigen::AngleAxisd(rate, Vec3::UnitZ()).toRotationMatrix();
  EXPECT_LE((known - rotation.orientation).norm(), 2e-8);  // 1.0e-8; with one substep in place of two 1.7e-7
}

// Times back to back are one time, and a turn goes back the way that it came.
TEST(FreeRotation, GoesBackTheWayItCame) {
  const Vec3 inertia(1, 2, 2.5);
  const detail::Rotation start{Mat3::Identity(), Vec3(0.1, 6, 0.1)};
  detail::Rotation rotation = detail::rotate_freely(start, inertia, 0.5);
  rotation.angular_velocity = -rotation.angular_velocity;
  rotation = detail::rotate_freely(rotation, inertia, 0.5);
  EXPECT_LE((rotation.orientation - start.orientation).norm(), 1e-8);
  EXPECT_LE((rotation.angular_velocity + start.angular_velocity).norm(), 1e-8);
}

TEST(FreeRotation, ABodyAtRestStays) {
  const detail::Rotation rotation = detail::rotate_freely({Mat3::Identity(), Vec3::Zero()}, Vec3(1, 2, 3), 1);
  EXPECT_EQ(rotation.angular_velocity, Vec3::Zero());
  EXPECT_EQ(rotation.orientation, Mat3::Identity());
}

}  // namespace
}  // namespace pd::test
