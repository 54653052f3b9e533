/// @file
/// Triangles of a polygon in space: a fan where it is convex, else ears cut off one after the other.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "pd/numeric/vector.hpp"

namespace pd::detail {

/// Appends the triangles of a loop, which runs as it does. Turns are decided exactly, in the shadow of the polygon on
/// the coordinate plane that `normal` is nearest to. Triangles on a line are left out.
/// @return false where the loop crosses itself, or is not convex and has more than kMostCorners: nothing is appended.
/// Time O(k) for convex loops of k corners, O(k^2) in general and O(k^3) at worst.
bool append_triangles(std::span<const Vec3> points, std::span<const std::int32_t> loop, const Vec3& normal,
                      std::vector<std::array<std::int32_t, 3>>& triangles);

}  // namespace pd::detail
