// The nearest point of a simplex: of sizes whose fourth powers leave the range of doubles, and among the faces of the
// newest point.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "depth/distance/gjk.hpp"

namespace pd::detail {
namespace {

std::vector<Vec3> corners(int count, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i) points.push_back({normal(random), normal(random), 2 + normal(random)});
  return points;
}

struct Nearest {
  DifferenceVertex simplex[4];
  double weights[4] = {0, 0, 0, 0};
  int count = 0;
  Vec3 point;

  explicit Nearest(const std::vector<Vec3>& points) {
    for (const Vec3& x : points) {
      simplex[count] = {x, count, 0};
      ++count;
    }
    point = closest_point_on_simplex(simplex, count, weights);
  }
};

TEST(NearestOnSimplex, IsAConvexCombinationAtAnySize) {
  std::mt19937_64 random(1);
  for (int round = 0; round < 200; ++round) {
    const std::vector<Vec3> points = corners(1 + round % 4, random);
    for (int exponent = -340; exponent <= 340; exponent += 4) {
      std::vector<Vec3> scaled;
      for (const Vec3& x : points) scaled.emplace_back(std::ldexp(1.0, exponent) * x);
      const Nearest nearest(scaled);
      ASSERT_GE(nearest.count, 1) << exponent;
      double total = 0;
      Vec3 sum = Vec3::Zero();
      for (int i = 0; i < nearest.count; ++i) {
        ASSERT_GT(nearest.weights[i], 0) << exponent;
        total += nearest.weights[i];
        sum += nearest.weights[i] * nearest.simplex[i].x;
      }
      ASSERT_NEAR(total, 1, 1e-14) << exponent;
      if (nearest.count < 4) {
        ASSERT_LE((sum - nearest.point).lpNorm<Eigen::Infinity>(), std::ldexp(1e-13, exponent)) << exponent;
      }
      double least = std::numeric_limits<double>::infinity();
      for (const Vec3& x : scaled) least = std::min(least, x.lpNorm<Eigen::Infinity>());
      // No farther than the nearest corner, whatever the size; sqrt(3) between the norms.
      ASSERT_LE(nearest.point.lpNorm<Eigen::Infinity>(), 1.75 * least) << exponent;
    }
  }
}

TEST(NearestOnSimplex, FacesOfTheNewestPointHoldTheNearestOne) {
  std::mt19937_64 random(2);
  int nearer = 0;
  for (int round = 0; round < 2000; ++round) {
    const std::vector<Vec3> points = corners(2 + round % 3, random);
    const Nearest all(points);
    // All but the last, reduced to the face of their nearest point.
    Nearest step(std::vector<Vec3>(points.begin(), points.end() - 1));
    const double before = step.point.norm();
    const double height = points.back().dot(step.point) / before;
    if (!(height < before)) continue;  // no support that a search goes on with
    step.simplex[step.count++] = {points.back(), static_cast<int>(points.size()) - 1, 0};
    step.point = closest_point_with_newest(step.simplex, step.count, step.weights);
    ++nearer;
    ASSERT_LT(step.point.norm(), before);
    ASSERT_GE(step.point.norm(), all.point.norm() - 1e-14);
  }
  EXPECT_GT(nearer, 500);
}

}  // namespace
}  // namespace pd::detail
