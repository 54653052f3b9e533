/// @file
/// The overlay depth engine against the exact oracle: class, and the nearest facet of P as an exact rational.
#include "depth/facets/overlay_depth.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "depth/difference/exact_support.hpp"
#include "oracle/depth_oracle.hpp"

namespace pd::detail {
namespace {

std::vector<Vec3> random_points(int n, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  std::vector<Vec3> points;
  for (int i = 0; i < n; ++i) points.push_back(Vec3{normal(random), normal(random), normal(random)}.normalized());
  return points;
}

Pose random_pose(std::mt19937_64& random, double spread) {
  std::normal_distribution<double> normal;
  std::array<double, 4> q{normal(random), normal(random), normal(random), normal(random)};
  const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  for (double& c : q) c /= length;
  return *Pose::from_quaternion(q, spread * Vec3{normal(random), normal(random), normal(random)});
}

/// Grid points with some coordinates constant: bodies of every dimension, nearly every pair degenerate.
std::vector<Vec3> grid_points(std::mt19937_64& random) {
  std::uniform_int_distribution<int> coordinate(-2, 2);
  std::vector<Vec3> points;
  const int n = 1 + static_cast<int>(random() % 9);
  const int constant = static_cast<int>(random() % 5);
  for (int i = 0; i < n; ++i) {
    Vec3 p = Eigen::Vector3i{coordinate(random), coordinate(random), coordinate(random)}.cast<double>();
    if (constant < 3) p[constant] = 1;
    points.push_back(0.5 * p);
  }
  return points;
}

struct Tally {
  int separated = 0;
  int touching = 0;
  int overlapping = 0;
};

void compare_with_oracle(const std::vector<Vec3>& points_a, const Pose& pose_a, const std::vector<Vec3>& points_b,
                         const Pose& pose_b, OverlayDepthBuffers& buffers, Tally& tally) {
  const ConvexPolytope a = *ConvexPolytope::from_points(points_a);
  const ConvexPolytope b = *ConvexPolytope::from_points(points_b);
  const PosedPair pair(a, pose_a, b, pose_b);
  const OverlayDepth found = overlay_depth(pair, buffers);

  const oracle::Body body_a(points_a), body_b(points_b);
  const oracle::ExactPair exact(body_a, pose_a, body_b, pose_b);
  oracle::JudgeSettings settings;
  settings.distance = false;
  const oracle::Verdict verdict = oracle::judge(exact, settings);
  ASSERT_EQ(found.contact, verdict.contact);
  switch (found.contact) {
    case ContactClass::separated:
      ++tally.separated;
      if (found.has_facet) {
        EXPECT_LT(pair.sign_determinant(found.facet.point(), found.facet.u, found.facet.v), 0);
      }
      return;
    case ContactClass::touching:
      ++tally.touching;
      if (found.has_facet) {
        EXPECT_EQ(pair.sign_determinant(found.facet.point(), found.facet.u, found.facet.v), 0);
      }
      return;
    case ContactClass::overlapping:
      ++tally.overlapping;
  }
  // depth = N / |n| with N times the cube and n times the square of the homogeneous factor; bracketed by two doubles
  // that the oracle's exact length must respect.
  ASSERT_TRUE(found.has_facet);
  const Dyadic3 n = cross(pair.exact(found.facet.u), pair.exact(found.facet.v));
  const Dyadic offset = dot(pair.exact(found.facet.point()), n);
  const double lower = verdict.depth.round_down(), upper = verdict.depth.round_up();
  const Dyadic squared = dot(n, n) * pair.homogeneous_factor() * pair.homogeneous_factor();
  EXPECT_GE((offset * offset - Dyadic(lower) * Dyadic(lower) * squared).sign(), 0);
  EXPECT_LE((offset * offset - Dyadic(upper) * Dyadic(upper) * squared).sign(), 0);
  const Vec3 unit = ExactDirection(n).unit;
  bool among_the_optima = false;
  for (const Vec3& normal : verdict.unit_normals) among_the_optima |= (normal - unit).norm() < 1e-12;
  EXPECT_TRUE(among_the_optima);
}

TEST(OverlayDepth, RandomPosedSolidsMatchTheOracle) {
  std::mt19937_64 random(11);
  OverlayDepthBuffers buffers;
  Tally tally;
  for (int round = 0; round < 1500 && !HasFailure(); ++round) {
    SCOPED_TRACE(round);
    const std::vector<Vec3> a = random_points(4 + round % 30, random);
    const std::vector<Vec3> b = random_points(4 + (7 * round) % 40, random);
    const Pose pose_a = random_pose(random, 0.5), pose_b = random_pose(random, 0.5);
    compare_with_oracle(a, pose_a, b, pose_b, buffers, tally);
  }
  EXPECT_GT(tally.separated, 20);
  EXPECT_GT(tally.overlapping, 500);
}

TEST(OverlayDepth, GridBodiesOfEveryDimensionMatchTheOracle) {
  std::mt19937_64 random(12);
  std::uniform_int_distribution<int> shift(-3, 3);
  OverlayDepthBuffers buffers;
  Tally tally;
  for (int round = 0; round < 6000 && !HasFailure(); ++round) {
    SCOPED_TRACE(round);
    const Pose pose_a = *Pose::from_matrix(
        Mat3::Identity(), 0.5 * Eigen::Vector3i{shift(random), shift(random), shift(random)}.cast<double>());
    const std::vector<Vec3> a = grid_points(random), b = grid_points(random);
    compare_with_oracle(a, pose_a, b, Pose(), buffers, tally);
  }
  EXPECT_GT(tally.separated, 300);
  EXPECT_GT(tally.touching, 300);
  EXPECT_GT(tally.overlapping, 300);
}

TEST(OverlayDepth, OneRotationOfBothBodiesKeepsTiesExact) {
  // The same quaternion on both bodies: relative positions stay degenerate although no posed coordinate is a double.
  std::mt19937_64 random(13);
  std::uniform_int_distribution<int> shift(-2, 2);
  OverlayDepthBuffers buffers;
  Tally tally;
  for (int round = 0; round < 1000 && !HasFailure(); ++round) {
    SCOPED_TRACE(round);
    const Pose pose = random_pose(random, 1);
    std::vector<Vec3> b = grid_points(random);
    const Vec3 move = 0.5 * Eigen::Vector3i{shift(random), shift(random), shift(random)}.cast<double>();
    for (Vec3& p : b) p += move;
    compare_with_oracle(grid_points(random), pose, b, pose, buffers, tally);
  }
  EXPECT_GT(tally.separated, 50);
  EXPECT_GT(tally.touching, 50);
  EXPECT_GT(tally.overlapping, 50);
}

TEST(OverlayDepth, EqualBodiesGiveTheWidth) {
  std::mt19937_64 random(14);
  OverlayDepthBuffers buffers;
  Tally tally;
  for (int round = 0; round < 100 && !HasFailure(); ++round) {
    const std::vector<Vec3> points = round % 2 ? random_points(4 + round, random) : grid_points(random);
    const Pose pose = random_pose(random, 1);
    compare_with_oracle(points, pose, points, pose, buffers, tally);
  }
}

TEST(OverlayDepth, ScalesFarFromOne) {
  std::mt19937_64 random(15);
  OverlayDepthBuffers buffers;
  Tally tally;
  for (const double scale : {1e-300, 1e-150, 1e-30, 1e30, 1e140}) {
    for (int round = 0; round < 20 && !HasFailure(); ++round) {
      std::vector<Vec3> a = random_points(12, random), b = random_points(12, random);
      for (Vec3& p : a) p *= scale;
      for (Vec3& p : b) p *= scale;
      const Pose pose_a = random_pose(random, 0.3 * scale), pose_b = random_pose(random, 0.3 * scale);
      compare_with_oracle(a, pose_a, b, pose_b, buffers, tally);
    }
  }
  EXPECT_GT(tally.overlapping, 50);
}

}  // namespace
}  // namespace pd::detail
