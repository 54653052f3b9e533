/// @file
/// How far a point is from a solid's surface.
#pragma once

#include "solid/posed_solids.hpp"

namespace pd::detail {

/// At most the distance of x from the surface (inside lengths), rounding included. The search ends, and the answer is
/// `enough` or less, once the surface is found to be nearer than `enough`.
[[nodiscard]] double distance_to_surface(const PosedSolids& solids, Body body, const Vec3& x, double enough);

}  // namespace pd::detail
