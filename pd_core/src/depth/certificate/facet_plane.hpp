/// @file
/// The plane of one facet of P in two stages: double-double with a proved error bound, and exact.
///
/// Lengths are those of the posed pair, scaled by its power of two.
#pragma once

#include <limits>

#include "numeric/double_double.hpp"
#include "numeric/dyadic.hpp"
#include "structure/overlay/facet_of_difference.hpp"

namespace pd::detail {

/// {x : <unit, x> = distance}, rounded.
struct FacetPlane {
  Vec3DD unit;            ///< outward normal
  double unit_error = 0;  ///< |error| of each coordinate of `unit`
  DoubleDouble distance;  ///< of the plane from the origin, positive inside
  double distance_error = std::numeric_limits<double>::infinity();
  /// 0 to 2: `unit` is that coordinate axis, or its opposite, nothing of the above has an error, and lengths are not
  /// scaled.
  int axis = -1;

  /// False where the normal drowned in rounding: nothing above may be used.
  [[nodiscard]] bool known() const { return distance_error < std::numeric_limits<double>::infinity(); }
};

/// The plane across a coordinate axis with the normal `sign` times the axis and that exact coordinate.
[[nodiscard]] FacetPlane plane_across_axis(int axis, double sign, const DoubleDouble& coordinate);

/// The plane across a coordinate axis with that point of P in it, where its height is exact: of the two normals the one
/// along which the point lies, which must not be 0.
[[nodiscard]] bool set_axis_plane(const PosedPair& pair, const PairVector& point, int axis, FacetPlane& plane);

/// About 1200 instructions with fused products; no allocation.
[[nodiscard]] FacetPlane measure_facet(const PosedPair& pair, const FacetOfDifference& facet);

/// The square of a plane's distance = numerator / denominator, in the homogeneous lengths of `PosedPair::exact`: fit to
/// be compared with that of another facet of the same pair.
struct SquaredFacetDistance {
  Dyadic numerator;
  Dyadic denominator;
};
[[nodiscard]] SquaredFacetDistance squared_distance(const PosedPair& pair, const FacetOfDifference& facet);
/// Sign of x - y.
[[nodiscard]] inline int compare(const SquaredFacetDistance& x, const SquaredFacetDistance& y) {
  return (x.numerator * y.denominator - y.numerator * x.denominator).sign();
}

}  // namespace pd::detail
