/// @file
/// An upper bound of the depth from directions that the bodies themselves name.
#pragma once

#include "depth/difference/smooth_difference.hpp"

namespace pd::detail {

/// A direction out of P and its height there: a bound of the depth from above.
struct WayOut {
  Vec3 normal;
  double upper;  ///< certified, >= 0
};

/// The least h_P(n) over the axes of both bodies, and across cores that are segments or polygons. Cores thinner than
/// rounding leave an expansion without a facet, and what is that thin is thin along one of these.
[[nodiscard]] WayOut thinnest_axis(const PosedShape& a, const PosedShape& b, const SmoothDifference& difference);

}  // namespace pd::detail
