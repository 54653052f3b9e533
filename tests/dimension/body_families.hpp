/// @file
/// Bodies of any dimension for tests: round, flat, slender and with corners; all of known points.
#pragma once

#include <algorithm>
#include <cmath>
#include <random>
#include <string_view>
#include <vector>

#include "pd/dimension/body.hpp"

namespace pd::dimension::test {

enum class Family { sphere, ball, cube, simplex, needle, slab };
inline constexpr Family kBodyFamilies[] = {Family::sphere,  Family::ball,   Family::cube,
                                           Family::simplex, Family::needle, Family::slab};

template <int D>
class BodySource {
 public:
  explicit BodySource(unsigned seed) : random_(seed) {}

  [[nodiscard]] double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  [[nodiscard]] Vector<D> direction() {
    std::normal_distribution<double> normal;
    Vector<D> v;
    do {
      for (int i = 0; i < D; ++i) v[i] = normal(random_);
    } while (!(v.norm() > 1e-3));
    return v / v.norm();
  }
  /// Gram-Schmidt, twice a column: Eigen's decompositions take each source half a minute to compile.
  [[nodiscard]] Matrix<D> rotation() {
    Matrix<D> m;
    for (int i = 0; i < D; ++i) {
      Vector<D> v;
      do {
        v = direction();
        for (int k = 0; k < 2 * i; ++k) v -= m.col(k % i).dot(v) * m.col(k % i);
      } while (!(v.norm() > 1e-3));
      m.col(i) = v / v.norm();
    }
    return m;
  }

  /// About the origin, of size about 1, turned at random; needles are 1e6 times longer than wide, slabs as much wider
  /// than thick.
  [[nodiscard]] std::vector<Vector<D>> points(Family family, int count) {
    std::vector<Vector<D>> r;
    if (family == Family::cube) {
      for (int k = 0; k < (1 << D); ++k) {
        Vector<D> p;
        for (int i = 0; i < D; ++i) p[i] = ((k >> i) & 1) != 0 ? 1 : -1;
        r.push_back(p);
      }
    } else if (family == Family::simplex) {
      for (int i = 0; i <= D; ++i) {
        r.push_back(i < D ? Vector<D>(Vector<D>::Unit(i)) : Vector<D>(Vector<D>::Constant(-0.4)));
      }
    } else {
      for (int i = 0; i < count; ++i) {
        Vector<D> p = direction();
        if (family == Family::ball) p *= std::pow(uniform(0, 1), 1.0 / D);
        r.push_back(p);
      }
    }
    if (family == Family::needle || family == Family::slab) {
      for (Vector<D>& p : r) {
        if (family == Family::needle) p.template tail<D - 1>() *= 1e-6;
        if (family == Family::slab) p[0] *= 1e-6;
      }
    }
    const Matrix<D> turn = rotation();
    for (Vector<D>& p : r) p = turn * p;
    return r;
  }

 private:
  std::mt19937_64 random_;
};

template <int D>
[[nodiscard]] Vector<D> extreme(const std::vector<Vector<D>>& points, const Vector<D>& v) {
  return *std::max_element(points.begin(), points.end(),
                           [&](const Vector<D>& a, const Vector<D>& b) { return a.dot(v) < b.dot(v); });
}

/// h(v) + h(-v): the directional width times |v|.
template <int D>
[[nodiscard]] double extent(const std::vector<Vector<D>>& points, const Vector<D>& v) {
  return extreme<D>(points, v).dot(v) - extreme<D>(points, -v).dot(v);
}

template <int D>
[[nodiscard]] std::vector<Vector<D>> image(const std::vector<Vector<D>>& points, const AffineMap<D>& map) {
  std::vector<Vector<D>> r;
  for (const Vector<D>& p : points) r.push_back(map.apply(p));
  return r;
}

}  // namespace pd::dimension::test
