/// @file
/// Clouds of points in R^D for the measurements of [M]'s bounds.
#pragma once

#include <cmath>
#include <random>
#include <string_view>
#include <vector>

#include "pd/dimension/body.hpp"

namespace pd::bench {

enum class Cloud { sphere, ball, box, needle, slab, simplex, cube };

[[nodiscard]] constexpr std::string_view to_string(Cloud cloud) {
  constexpr std::string_view kNames[] = {"sphere", "ball", "box", "needle", "slab", "simplex", "cube"};
  return kNames[static_cast<int>(cloud)];
}

inline double uniform(std::mt19937_64& random) { return static_cast<double>(random() >> 11) * 0x1p-52 - 1; }

template <int D>
dimension::Vector<D> direction(std::mt19937_64& random) {
  for (;;) {
    dimension::Vector<D> v;
    for (int k = 0; k < D; ++k) v[k] = uniform(random);
    const double squared = v.squaredNorm();
    if (squared <= 1 && squared > 1e-6) return v / std::sqrt(squared);
  }
}

/// n points. Needles and slabs are spheres stretched by 1e6 and 1e-6 along a diagonal; simplices and cubes are
/// their corners and points inside.
template <int D>
std::vector<dimension::Vector<D>> cloud(Cloud kind, std::size_t n, std::mt19937_64& random) {
  std::vector<dimension::Vector<D>> points(n);
  const dimension::Vector<D> axis = dimension::Vector<D>::Ones() / std::sqrt(static_cast<double>(D));
  for (std::size_t i = 0; i < n; ++i) {
    dimension::Vector<D>& p = points[i];
    if (kind == Cloud::box || kind == Cloud::cube) {
      for (int k = 0; k < D; ++k) p[k] = uniform(random);
      if (kind == Cloud::cube && i < std::size_t{1} << D) {
        for (int k = 0; k < D; ++k) p[k] = ((i >> k) & 1) != 0 ? 1 : -1;
      }
    } else if (kind == Cloud::simplex) {
      double sum = 0;
      for (int k = 0; k < D; ++k) sum += p[k] = std::abs(uniform(random));
      p /= sum + std::abs(uniform(random));
      if (i <= D) p = i < D ? dimension::Vector<D>(dimension::Vector<D>::Unit(static_cast<int>(i))) : 0 * p;
    } else {
      p = direction<D>(random);
      if (kind == Cloud::ball) p *= std::pow(std::abs(uniform(random)), 1.0 / D);
      const double stretch = kind == Cloud::needle ? 1e6 : kind == Cloud::slab ? 1e-6 : 1;
      const double along = p.dot(axis);
      p += (stretch - 1) * along * axis;
    }
  }
  return points;
}

}  // namespace pd::bench
