/// @file
/// The simplex in lanes of doubles: its nearest point is a convex combination, at any size, and comes nearer with each
/// support.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "depth/distance/lane_simplex.hpp"

namespace pd::detail {
namespace {

std::vector<Vec3> corners(int count, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i) points.push_back({normal(random), normal(random), 2 + normal(random)});
  return points;
}

LaneSimplex simplex_of(const std::vector<Vec3>& points) {
  LaneSimplex simplex;
  int id = 0;
  for (const Vec3& x : points) simplex.add({x, id++, 0});
  return simplex;
}

TEST(LaneSimplex, IsAConvexCombinationAtAnySize) {
  std::mt19937_64 random(1);
  for (int round = 0; round < 200; ++round) {
    const std::vector<Vec3> points = corners(1 + round % 3, random);
    for (int exponent = -160; exponent <= 100; exponent += 4) {
      std::vector<Vec3> scaled;
      for (const Vec3& x : points) scaled.emplace_back(std::ldexp(1.0, exponent) * x);
      const LaneSimplex nearest = simplex_of(scaled);
      ASSERT_GE(nearest.count(), 1) << exponent;
      double total = 0, least = std::numeric_limits<double>::infinity();
      for (int i = 0; i < nearest.count(); ++i) {
        ASSERT_GT(nearest.weight(i), 0) << exponent;
        total += nearest.weight(i);
      }
      for (const Vec3& x : scaled) least = std::min(least, x.norm());
      ASSERT_NEAR(total, 1, 1e-14) << exponent;
      ASSERT_NEAR(nearest.toward().norm(), 1, 1e-13) << exponent;
      const double length = nearest.point().norm();
      ASSERT_LE((nearest.point() + length * nearest.toward()).norm(), std::ldexp(1e-11, exponent)) << exponent;
      ASSERT_LE(length, least * (1 + 1e-14)) << exponent;
    }
  }
}

TEST(LaneSimplex, ComesNearerWithEachSupport) {
  std::mt19937_64 random(2);
  int nearer = 0;
  for (int round = 0; round < 2000; ++round) {
    const std::vector<Vec3> points = corners(2 + round % 3, random);
    LaneSimplex simplex = simplex_of(std::vector<Vec3>(points.begin(), points.end() - 1));
    const double before = simplex.point().norm();
    const double height = -points.back().dot(simplex.toward());
    if (!(height < before)) continue;  // no support that a search goes on with
    if (!simplex.add({points.back(), 4, 0})) {
      ASSERT_TRUE(simplex.encloses());
      continue;
    }
    ++nearer;
    ASSERT_LT(simplex.point().norm(), before);
    ASSERT_TRUE(simplex.has_corner({Vec3::Zero(), 4, 0}));
  }
  EXPECT_GT(nearer, 500);
}

}  // namespace
}  // namespace pd::detail
