/// @file
/// The farthest point of a posed shape in a direction, in doubles: for bounds whose slack is far above rounding.
/// `support_of_difference` (pd/depth/difference_queries.hpp) decides ties exactly, and every facet normal is one.
#pragma once

#include "pd/shape/convex_shape.hpp"

namespace pd {

/// The point of the core that is farthest in a finite direction, in the common frame; margins are left aside. Of
/// several vertices the first. Time O(v) in v vertices of a polytope, O(1) of a smooth core.
[[nodiscard]] Vec3 farthest_point(const PosedShape& posed, const Vec3& direction);

/// The largest <q - p, n> over the points q of b and p of a, margins included; n unit. If it is negative, a plane
/// across n parts them.
[[nodiscard]] double reach_along(const PosedShape& a, const PosedShape& b, const Vec3& n);

}  // namespace pd
