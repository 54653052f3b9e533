/// @file
/// [M] section 3.1: a convex function minimised by trisection, one variable inside the other (Lemmas 14 and 15).
///
/// A level of Lemma 14 whose function is known to within e ends within 7 e of the minimum, plus what the length at
/// which it stops costs; with that length chosen as e / slope each level multiplies the error by 8. [M] hides the
/// factor in O(epsilon).
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "dimension/support_body.hpp"

namespace pd::dimension::detail {

/// An orthogonal matrix whose last column is -`unit`: w -> axes * (w_1, .., w_(N-1), 1) runs over the directions that
/// look down along `unit`.
LiftedMatrix frame_along(const Point& unit) {
  const Eigen::Index n = unit.size();
  // A Householder reflection that maps the last axis to -unit (or, where that cancels, to unit and a change of sign).
  Point mirror = unit;
  const double sign = unit(n - 1) >= 0 ? 1 : -1;
  mirror(n - 1) += sign;
  LiftedMatrix axes = LiftedMatrix::Identity(n, n);
  const double twice = 2 / mirror.squaredNorm();
  for (Eigen::Index k = 0; k < n; ++k) add_scaled(&axes(0, k), -twice * mirror(k), mirror.data(), n);
  axes.col(n - 1) = -unit;
  return axes;
}

/// Lemma 15 over the cube [-half_side, half_side]^(N-1); the last coordinate of every argument is 1.
struct NestedTernary {
  double half_side;  ///< a copy of [M]'s alpha
  double slope;      ///< of the function in every coordinate, at most
  double tolerance;  ///< error of the innermost level; the k-th level's is 8^(k-1) times that

  /// @param stop  asked after every trisection: true ends the search
  template <class Function, class Stop>
  double minimise(Eigen::Index size, const Function& f, const Stop& stop) const {
    Point w = Point::Ones(size);
    return minimise_from(0, size, w, f, stop);
  }

 private:
  /// g(x_level) of Lemma 15: the least value over the coordinates from `level` on.
  template <class Function, class Stop>
  double minimise_from(Eigen::Index level, Eigen::Index size, Point& w, const Function& f, const Stop& stop) const {
    if (level == size - 1) return f(w);
    const double error = tolerance * std::pow(8.0, static_cast<double>(size - 2 - level));
    const auto value = [&](double x) {
      w(level) = x;
      return minimise_from(level + 1, size, w, f, stop);
    };
    double low = -half_side;
    double high = half_side;
    double at_low = value(low);
    double at_high = value(high);
    double least = std::min(at_low, at_high);
    while (slope * (high - low) > error && !stop()) {
      const std::array<double, 4> x = {low, low + (high - low) / 3, high - (high - low) / 3, high};
      const std::array<double, 4> y = {at_low, value(x[1]), value(x[2]), at_high};
      std::size_t m = 0;
      for (std::size_t i = 1; i < 4; ++i) {
        if (y[i] < y[m]) m = i;
      }
      least = std::min(least, y[m]);
      const std::size_t left = m == 0 ? 0 : m - 1;
      const std::size_t right = m == 3 ? 3 : m + 1;
      low = x[left];
      high = x[right];
      at_low = y[left];
      at_high = y[right];
    }
    return least;
  }
};

}  // namespace pd::dimension::detail
