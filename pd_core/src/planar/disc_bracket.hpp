/// @file
/// A polygon swept by a disc, between two polygons.
///
/// The disc lies between a regular polygon whose corners are on its circle and one whose edges touch the circle. So R
/// swept by the disc lies between the differences of P and of Q swept by these, if one of P and Q is convex. A way out
/// for good of the larger one is a way out of R swept, and the smaller one's least way bounds it from below.
#pragma once

#include <memory>

#include "numeric/dyadic.hpp"
#include "pd/planar/polygon_depth.hpp"

namespace pd::detail {

struct DiscBracket {
  Dyadic radius;
  PolygonDifference inner, outer;

  /// Corners of the regular polygons: the two are 1.5e-7 of the radius apart.
  static constexpr int kCorners = 8192;
  /// @param low, high  doubles around the radius
  /// @return unsupported ("complete") if neither polygon is convex; errors of PolygonDifference::of.
  static Expected<std::shared_ptr<const DiscBracket>> of(const Polygon& p, const Polygon& q, const Dyadic& radius,
                                                         double low, double high);
};

}  // namespace pd::detail
