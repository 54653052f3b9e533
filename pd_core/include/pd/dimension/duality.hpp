/// @file
/// The projective duality of [M] section 2.2: points to hyperplanes and back, and width as thickness (Lemma 11).
///
/// p = (p_1, ..., p_d) maps to the hyperplane p*: x_d = p_1 x_1 + ... + p_{d-1} x_{d-1} - p_d. The hyperplane x_d = a_1
/// x_1 + ... + a_{d-1} x_{d-1}
/// - a_d maps to the point a. The map is an involution, it keeps incidence
/// (p on q* exactly when q on p*) and turns above into above: p lies above q* exactly when q lies above p*.
#pragma once

#include <algorithm>
#include <span>

#include "pd/dimension/vector.hpp"

namespace pd::dimension {

/// x_d = <slopes, (x_1, ..., x_{d-1})> - drop.
template <int D>
struct GraphHyperplane {
  Eigen::Matrix<double, D - 1, 1, Eigen::DontAlign> slopes;
  double drop;

  /// x_d above or below r = (x_1, ..., x_{d-1}).
  [[nodiscard]] double height(const Eigen::Matrix<double, D - 1, 1, Eigen::DontAlign>& r) const {
    return slopes.dot(r) - drop;
  }
};

template <int D>
[[nodiscard]] GraphHyperplane<D> dual_hyperplane(const Vector<D>& point) {
  return {point.template head<D - 1>(), point[D - 1]};
}

template <int D>
[[nodiscard]] Vector<D> dual_point(const GraphHyperplane<D>& hyperplane) {
  Vector<D> r;
  r << hyperplane.slopes, hyperplane.drop;
  return r;
}

/// thick_r: the distance along the vertical line over r between the upper and the lower envelope of the hyperplanes
/// dual to the points. Lemma 11: it is |v| width_v(points) for v = (r, -1). Requires a point.
template <int D>
[[nodiscard]] double thickness(std::span<const Vector<D>> points,
                               const Eigen::Matrix<double, D - 1, 1, Eigen::DontAlign>& r) {
  double low = dual_hyperplane<D>(points[0]).height(r), high = low;
  for (const Vector<D>& p : points.subspan(1)) {
    const double height = dual_hyperplane<D>(p).height(r);
    low = std::min(low, height);
    high = std::max(high, height);
  }
  return high - low;
}

}  // namespace pd::dimension
