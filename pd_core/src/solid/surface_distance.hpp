/// @file
/// How far a point is from a solid's surface: bounds from below and from above.
#pragma once

#include <cmath>

#include "solid/posed_solids.hpp"

namespace pd::detail {

/// The nearest triangle, as found in doubles (another one may be nearer by some rounding errors), and at most the
/// distance of x from the surface (inside lengths), rounding included.
struct NearestTriangle {
  std::int32_t triangle = -1;
  double distance = 0;
  Vec3 foot = Vec3::Zero();  ///< the point of the triangle that is nearest, rounded
};
/// @param at_most  the distance, as far as it is known: only nearer triangles are found; -1: there is none.
[[nodiscard]] NearestTriangle nearest_triangle(const PosedSolids& solids, Body body, const Vec3& x,
                                               double at_most = HUGE_VAL);

/// At least the distance of x from a triangle (inside lengths), rounding included.
[[nodiscard]] double reach_to_triangle(const PosedTriangle& triangle, const Vec3& x);

}  // namespace pd::detail
