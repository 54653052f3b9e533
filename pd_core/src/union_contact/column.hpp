/// @file
/// Tells whether a body that lies behind a triangle's plane at one place comes through the triangle there.
#pragma once

#include "pd/shape/convex_shape.hpp"

namespace pd::detail {

/// A body that is this share of its thickness deep in a plane is looked at where it is deepest. The plane goes on
/// beyond its triangle, and a body that reaches over the triangle's edge may lie behind it there as a whole.
inline constexpr double kLookedAt = 1.0 / 64;

/// Returns true if the way of this length along n from a point of the body's surface ends in the body; false, too, for
/// a curved body. Time O(f).
/// @param from  a farthest point along -n, in the world
/// @param n     unit
[[nodiscard]] bool reaches_back(const PosedShape& body, const Vec3& from, const Vec3& n, double length);

/// Returns a point in the middle of the body, in the world; of a curved one its origin. Time O(v).
[[nodiscard]] Vec3 middle_of(const PosedShape& body);

}  // namespace pd::detail
