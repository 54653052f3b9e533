/// @file
/// How a body's solid is spread: what searches take its shape from before they have asked for any support. They decide
/// nothing by it but where to look first.
#pragma once

#include "pd/shape/convex_polytope.hpp"

namespace pd::detail {

/// The second moments of the solid about its centroid, divided by its volume, in the body's frame; of a body that is
/// flat, about, those of its vertices about their mean. Infinite or 0 where squares of lengths leave the range of
/// doubles. Time O(n).
Mat3 second_moments(const ConvexPolytope::Storage& body);

/// Whether a body is so far from round that directions had better be laid out in the frame of its moments: the product
/// of the squared semi-axes of the ellipsoid of these moments is below half of what it is for a ball of their sum.
/// Balls, cubes and short prisms are not.
bool is_elongated(const Mat3& second_moments);

}  // namespace pd::detail
