/// @file
/// How far a point lies outside a body of any kind, in long double and by no code of the library's engines.
#pragma once

#include "pd/shape/convex_shape.hpp"

namespace pd::oracle {

/// The distance of a point from a posed body with its margin; 0 inside. Exact up to rounding of long double, but for
/// hulls of spheres of unequal radii, where the distance is at most what is returned and at least 1e-13 of the size
/// less.
[[nodiscard]] long double distance_outside(const PosedShape& body, const Vec3& point);

}  // namespace pd::oracle
