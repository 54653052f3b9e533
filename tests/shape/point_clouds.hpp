/// @file
/// Point sets that hull builders find easy, hard and degenerate; the same for the same seed.
#pragma once

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "pd/numeric/vector.hpp"

namespace pd::test {

using Points = std::vector<Vec3>;

inline double uniform(std::mt19937_64& random) { return std::uniform_real_distribution<double>(-1, 1)(random); }

inline Points box_cloud(int n, unsigned seed) {
  std::mt19937_64 random(seed);
  Points points;
  for (int i = 0; i < n; ++i) {
    const double x = uniform(random);
    const double y = uniform(random);
    points.emplace_back(x, y, uniform(random));
  }
  return points;
}

inline Points ball_cloud(int n, unsigned seed) {
  std::mt19937_64 random(seed);
  Points points;
  while (static_cast<int>(points.size()) < n) {
    const double x = uniform(random);
    const double y = uniform(random);
    const Vec3 p(x, y, uniform(random));
    if (p.squaredNorm() <= 1) points.push_back(p);
  }
  return points;
}

inline Points sphere_cloud(int n, unsigned seed) {
  Points points = ball_cloud(n, seed);
  for (Vec3& p : points) p.normalize();
  return points;
}

/// k^3 points of an integer lattice under a linear map.
inline Points lattice(int k, const Mat3& map) {
  Points points;
  for (int x = 0; x < k; ++x) {
    for (int y = 0; y < k; ++y) {
      for (int z = 0; z < k; ++z) points.push_back(map * Vec3(x, y, z));
    }
  }
  return points;
}

/// Random points on the six sides of a cube, the corners not among them.
inline Points cube_sides(int n, unsigned seed) {
  Points points = box_cloud(n, seed);
  for (int i = 0; i < n; ++i) points[static_cast<std::size_t>(i)][i % 3] = (i / 3) % 2 == 0 ? -1 : 1;
  return points;
}

/// All integer points at one distance from the origin: exactly cospherical, with large coplanar groups.
inline Points cospherical(int squared_radius) {
  Points points;
  const int r = static_cast<int>(std::sqrt(squared_radius)) + 1;
  for (int x = -r; x <= r; ++x) {
    for (int y = -r; y <= r; ++y) {
      for (int z = -r; z <= r; ++z) {
        if (x * x + y * y + z * z == squared_radius) points.emplace_back(x, y, z);
      }
    }
  }
  return points;
}

inline Points shuffled(Points points, unsigned seed) {
  std::mt19937_64 random(seed);
  std::shuffle(points.begin(), points.end(), random);
  return points;
}

}  // namespace pd::test
