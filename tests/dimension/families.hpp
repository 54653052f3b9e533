/// @file
/// Bodies and directions that are hard on approximations, for every dimension.
#pragma once

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "pd/dimension/body.hpp"

namespace pd::dimension::test {

using Random = std::mt19937_64;

inline double uniform(Random& random) { return static_cast<double>(random() >> 11) * 0x1p-52 - 1; }
inline double bell(Random& random) {
  double sum = 0;
  for (int i = 0; i < 12; ++i) sum += uniform(random);
  return sum / 2;
}

template <int D>
Vector<D> random_direction(Random& random) {
  Vector<D> v;
  do {
    for (int k = 0; k < D; ++k) v[k] = bell(random);
  } while (v.norm() < 1e-3);
  return v.normalized();
}

/// A matrix of random orientation with the first axis stretched by `aspect`.
template <int D>
Matrix<D> random_stretch(Random& random, double aspect) {
  Matrix<D> q;
  for (int k = 0; k < D; ++k) {
    Vector<D> v;
    do {
      v = random_direction<D>(random);
      for (int j = 0; j < k; ++j) v -= Vector<D>(q.col(j)).dot(v) * q.col(j);
    } while (v.norm() < 0.1);
    q.col(k) = v.normalized();
  }
  q.col(0) *= aspect;
  return q;
}

inline constexpr int kFamilies = 9;
inline std::string family_name(int family) {
  static const char* const kNames[kFamilies] = {"sphere", "ball", "cube",          "simplex",     "grid",
                                                "needle", "slab", "twin clusters", "tilted prism"};
  return kNames[family];
}

/// Points of a family, about n where it has no size of its own.
template <int D>
std::vector<Vector<D>> family_points(int family, int n, Random& random) {
  std::vector<Vector<D>> points;
  const auto corners = [&](double size) {
    for (int s = 0; s < (1 << D); ++s) {
      Vector<D> p;
      for (int k = 0; k < D; ++k) p[k] = ((s >> k) & 1) != 0 ? size : -size;
      points.push_back(p);
    }
  };
  const auto fill = [&](double power) {
    for (int i = 0; i < n; ++i) {
      const double radius = std::pow(std::abs(uniform(random)), power);
      points.push_back(random_direction<D>(random) * radius);
    }
  };
  if (family == 2) corners(1);
  if (family == 3) {
    points.push_back(Vector<D>::Zero());
    for (int k = 0; k < D; ++k) points.push_back(Vector<D>::Unit(k));
    points.push_back(Vector<D>::Constant(0.1 / D));
  }
  if (family == 4) {
    for (int i = 0; i < n; ++i) {
      Vector<D> p;
      for (int k = 0; k < D; ++k) p[k] = std::round(4 * uniform(random));
      points.push_back(p);
    }
    corners(4);
  }
  if (family == 8) {  // facets with many vertices
    for (int i = 0; i < n; ++i) {
      Vector<D> p = random_direction<D>(random);
      p[D - 1] = 0;
      if (p.norm() < 1e-3) continue;
      p.normalize();
      for (const double height : {-0.5, 0.5}) {
        p[D - 1] = height;
        points.push_back(p);
      }
    }
  }
  if (family == 0 || (family >= 5 && family <= 7)) fill(0);
  if (family == 1) fill(1.0 / D);
  if (family == 7) {  // two small clusters far apart, farther from the origin
    for (std::size_t i = 0; i < points.size(); ++i) {
      points[i] *= 1e-3;
      if (i % 2 == 0) points[i][D - 1] += 1;
      points[i] += Vector<D>::Constant(10);
    }
  }
  const double aspect = family == 5 ? 1e6 : family == 6 ? 1e-6 : 1;
  if (family == 5 || family == 6 || family == 8) {
    const Matrix<D> map = random_stretch<D>(random, aspect);
    for (Vector<D>& p : points) p = map * p;
  }
  return points;
}

/// Axes, random directions, random ones of the frame where the body is fat (most are thin ones of the body), and
/// normals of hyperplanes through points.
template <int D>
std::vector<Vector<D>> hard_directions(const Body<D>& body, int count, Random& random) {
  std::vector<Vector<D>> directions;
  for (int k = 0; k < D; ++k) directions.push_back(Vector<D>::Unit(k));
  const Matrix<D> fat = body.sandwich().fattening().linear;
  for (int i = 0; i < count; ++i) {
    directions.push_back(random_direction<D>(random));
    directions.push_back(fat.transpose() * random_direction<D>(random));
    if (body.representation() != Representation::points) continue;
    Matrix<D> through;
    const auto any = [&] { return body.points()[random() % body.points().size()]; };
    const Vector<D> origin = any();
    for (int k = 0; k + 1 < D; ++k) through.row(k) = (fat * (any() - origin)).transpose();
    through.row(D - 1) = random_direction<D>(random).transpose();
    const Vector<D> normal = inverse_of<D>(through) * Vector<D>::Unit(D - 1);
    if (normal.allFinite() && normal.norm() > 1e-6) directions.push_back(fat.transpose() * normal.normalized());
  }
  return directions;
}

/// By a scan, unrelated to any structure.
template <int D>
double scanned_support(std::span<const Vector<D>> points, const Vector<D>& direction) {
  double high = -INFINITY;
  for (const Vector<D>& p : points) high = std::max(high, direction.dot(p));
  return high;
}
template <int D>
double scanned_extent(std::span<const Vector<D>> points, const Vector<D>& direction) {
  return scanned_support<D>(points, direction) + scanned_support<D>(points, -direction);
}

}  // namespace pd::dimension::test
