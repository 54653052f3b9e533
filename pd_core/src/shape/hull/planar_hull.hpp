/// @file
/// Convex hull of coplanar points in space.
#pragma once

#include <vector>

#include "shape/hull/affine_frame.hpp"

namespace pd::detail {

/// The hull's vertices in cyclic order, no three collinear. Requires frame.dimension == 2.
///
/// Andrew's monotone chain on the projection along an axis that keeps the frame's triangle proper: on the plane that
/// projection is one to one and affine, so hulls correspond. Time O(n log n).
[[nodiscard]] std::vector<int> planar_hull(const HullPoints& points, const AffineFrame& frame);

}  // namespace pd::detail
