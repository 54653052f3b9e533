/// @file
/// Width: pi(P, P) by two engines, bodies whose width is known, and a sweep of directions.
#include "pd/depth/width.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "pd/depth/scratch.hpp"

namespace pd {
namespace {

std::vector<Vec3> sphere_points(int n, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  std::vector<Vec3> points;
  for (int i = 0; i < n; ++i) points.push_back(Vec3{normal(random), normal(random), normal(random)}.normalized());
  return points;
}

Pose random_pose(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  std::array<double, 4> q{normal(random), normal(random), normal(random), normal(random)};
  const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  for (double& c : q) c /= length;
  return *Pose::from_quaternion(q, Vec3{normal(random), normal(random), normal(random)});
}

double extent(const std::vector<Vec3>& points, const Pose& pose, const Vec3& n) {
  double low = HUGE_VAL, high = -HUGE_VAL;
  for (const Vec3& p : points) {
    low = std::min(low, pose.apply(p).dot(n));
    high = std::max(high, pose.apply(p).dot(n));
  }
  return high - low;
}

TEST(Width, EnginesAgreeAndTheNormalAttainsIt) {
  std::mt19937_64 random(31);
  std::normal_distribution<double> normal;
  Scratch scratch;
  for (int round = 0; round < 120 && !HasFailure(); ++round) {
    const std::vector<Vec3> points = sphere_points(4 + round % 40, random);
    const ConvexShape shape(*ConvexPolytope::from_points(points));
    const Pose pose = random_pose(random);
    const Width overlay = width({&shape, pose}, scratch);
    const Width expansion = width({&shape, pose}, scratch, Method::expansion);
    EXPECT_EQ(overlay.lower, expansion.lower);
    EXPECT_EQ(overlay.upper, expansion.upper);
    EXPECT_LE(overlay.upper, std::nextafter(overlay.lower, HUGE_VAL));
    EXPECT_NEAR(extent(points, pose, overlay.normal), overlay.width, 1e-14);
    EXPECT_NEAR(overlay.normal.norm(), 1, 1e-15);
    for (int i = 0; i < 200; ++i) {
      const Vec3 n = Vec3{normal(random), normal(random), normal(random)}.normalized();
      EXPECT_GE(extent(points, pose, n), overlay.lower - 1e-14);
    }
  }
}

TEST(Width, EqualsDepthOfABodyInItself) {
  std::mt19937_64 random(32);
  Scratch scratch;
  DepthSettings tightest;
  tightest.bracket = Bracket::tightest;
  for (int round = 0; round < 40; ++round) {
    const ConvexShape shape(*ConvexPolytope::from_points(sphere_points(4 + round, random)));
    const Pose pose = random_pose(random);
    const PenetrationDepth depth = penetration_depth({&shape, pose}, {&shape, pose}, scratch, tightest);
    const Width found = width({&shape, pose}, scratch);
    EXPECT_EQ(found.lower, depth.lower);
    // A depth's upper end may be one double higher, so that a translation of that length exists in doubles.
    EXPECT_LE(found.upper, depth.upper);
    EXPECT_LE(depth.upper, std::nextafter(found.upper, HUGE_VAL));
  }
}

TEST(Width, KnownBodies) {
  Scratch scratch;
  const auto of = [&](const ConvexShape& shape) { return width({&shape, Pose()}, scratch); };
  EXPECT_EQ(of(*ConvexPolytope::box(Vec3(3, 1, 2))).width, 2);
  // A regular tetrahedron of edge s: s / sqrt 2, between opposite edges; a regular octahedron: s sqrt(2/3).
  const std::vector<Vec3> tetrahedron{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
  EXPECT_EQ(of(*ConvexPolytope::from_points(tetrahedron)).width, 2);
  const std::vector<Vec3> octahedron{{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  EXPECT_DOUBLE_EQ(of(*ConvexPolytope::from_points(octahedron)).width, 2 / std::sqrt(3.0));

  EXPECT_EQ(of(*ConvexShape::sphere(0.3)).width, 0.6);
  EXPECT_EQ(of(*ConvexShape::capsule(0.25, 2, 1)).width, 0.5);
  EXPECT_EQ(of(*ConvexShape::ellipsoid(Vec3(3, 2, 5))).width, 4);
  EXPECT_EQ(of(*ConvexShape::cylinder(1, 3, 2)).width, 2);
  EXPECT_EQ(of(*ConvexShape::cylinder(3, 1, 2)).width, 2);
  EXPECT_EQ(of(*ConvexShape::cone(3, 1, 2)).width, 2);
  EXPECT_DOUBLE_EQ(of(*ConvexShape::cone(1, 2, 0)).width, 8 / std::sqrt(17.0));
  // It holds the unit ball, and is as wide across its axis.
  const Width tapered = of(*ConvexShape::hull_of_spheres(std::vector<Sphere>{{{0, 0, 0}, 1}, {{3, 0, 0}, 0.5}}));
  EXPECT_LE(tapered.lower, 2);
  EXPECT_GE(tapered.upper, 2);
  EXPECT_LE(tapered.upper, 2 * (1 + 1e-6));

  const std::vector<Vec3> square{{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  const Width flat = of(*ConvexPolytope::from_points(square));
  EXPECT_EQ(flat.upper, 0);
  EXPECT_EQ(std::abs(flat.normal.z()), 1);
  const ConvexShape plate = *ConvexShape(*ConvexPolytope::from_points(square)).with_margin(0.125);
  EXPECT_EQ(of(plate).width, 0.25);
}

TEST(Width, SmoothNormalsAttainIt) {
  std::mt19937_64 random(33);
  Scratch scratch;
  for (const double radius : {0.5, 1.0, 1.7, 4.0}) {
    const ConvexShape cone = *ConvexShape::cone(radius, 1, 2);
    const Width found = width({&cone, Pose()}, scratch);
    // Extent of the cone along its normal: the apex against the base circle.
    const auto extent_at = [&](const Vec3& n) {
      const double across = radius * std::hypot(n.x(), n.y());
      return std::max(n.z(), -n.z() + across) - std::min(n.z(), -n.z() - across);
    };
    EXPECT_NEAR(extent_at(found.normal), found.width, 1e-14);
    for (int i = 0; i <= 1000; ++i) {
      const double t = i * 1.5707963 / 1000;
      EXPECT_GE(extent_at(Vec3(std::sin(t), 0, std::cos(t))), found.lower - 1e-14);
    }
  }
}

/// Directions that cover the sphere evenly see nothing of the box but its two faces: they are laid out as thin as it
/// is.
TEST(Width, GridOfABoxThinnerThanRounding) {
  Scratch scratch;
  for (const double thickness : {1e-3, 1e-18, 1e-100, 1e-150}) {
    const ConvexShape box(*ConvexPolytope::box({0.5, 0.5, 0.5 * thickness}));
    const Width found = width({&box, Pose()}, scratch, Method::grid, 1e-2);
    EXPECT_TRUE(found.bracket_reached) << thickness;
    EXPECT_LE(found.lower, thickness);
    EXPECT_GE(found.upper, thickness);
    EXPECT_LE(found.upper, 1.01 * found.lower * (1 + 1e-12)) << thickness;
    EXPECT_LT(found.statistics.facets_visited, 2000) << thickness;
  }
}

/// A turned box that is thinner than the rounding of its corners: what rounding leaves of the bracket is said.
TEST(Width, GridsSayWhatTheyDoNotReach) {
  Scratch scratch;
  for (const double thickness : {1e-6, 1e-10, 1e-14}) {
    const ConvexShape box(*ConvexPolytope::box({1, 1, thickness}));
    const Pose turned = *Pose::from_quaternion({0.5, 0.5, 0.1, 0.7}, {3, 0, 0});
    const Width found = width({&box, turned}, scratch, Method::grid, 1e-2), exact = width({&box, turned}, scratch);
    EXPECT_LE(found.lower, exact.upper);
    EXPECT_GE(found.upper, exact.lower);
    EXPECT_EQ(found.bracket_reached, found.upper <= 1.01 * found.lower * (1 + 1e-12)) << thickness;
    EXPECT_LE(found.statistics.facets_visited, 1 << 15) << thickness;
  }
}

}  // namespace
}  // namespace pd
