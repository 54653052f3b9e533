/// @file
/// Triangles of a surface that meet elsewhere than in a common edge or vertex, found exactly.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "pd/numeric/vector.hpp"

namespace pd::detail {

/// Vertices and the face that the triangle is a part of.
struct FaceTriangle {
  std::array<std::int32_t, 3> vertices;
  std::int32_t face;
};

/// Do two triangles, none of which lies on a line, have a point in common that no common edge or vertex explains?
/// Decided by the signs of exact determinants.
[[nodiscard]] bool cross(std::span<const Vec3> points, const FaceTriangle& s, const FaceTriangle& t);

/// Calls `found` with the faces of every two triangles of different faces that cross.
/// @param budget  most visits of two boxes or triangles
/// @return false where the budget ended before the search
bool find_crossings(std::span<const Vec3> points, const std::vector<FaceTriangle>& triangles, std::int64_t budget,
                    const std::function<void(std::int32_t, std::int32_t)>& found);

}  // namespace pd::detail
