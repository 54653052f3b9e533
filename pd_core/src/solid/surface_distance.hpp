/// @file
/// How far a point is from a solid's surface: bounds from below and from above.
#pragma once

#include "solid/posed_solids.hpp"

namespace pd::detail {

/// At most the distance of x from the surface (inside lengths), rounding included. The search ends, and the answer is
/// `enough` or less, once the surface is found to be nearer than `enough`.
[[nodiscard]] double distance_to_surface(const PosedSolids& solids, Body body, const Vec3& x, double enough);

/// The nearest triangle, as found in doubles (another one may be nearer by some rounding errors), and at most the
/// distance of x from the surface.
struct NearestTriangle {
  std::int32_t triangle = 0;
  double distance = 0;
};
[[nodiscard]] NearestTriangle nearest_triangle(const PosedSolids& solids, Body body, const Vec3& x);

/// At least the distance of x from a triangle (inside lengths), rounding included.
[[nodiscard]] double reach_to_triangle(const PosedTriangle& triangle, const Vec3& x);

}  // namespace pd::detail
