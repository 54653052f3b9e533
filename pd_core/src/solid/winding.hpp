/// @file
/// How often a solid's surface runs around a point: 1 inside, 0 outside, exactly.
#pragma once

#include <cstdint>
#include <optional>

#include "solid/posed_solids.hpp"

namespace pd::detail {

struct PointPlace {
  bool on_surface = false;
  int winding = 0;
};

/// The place of a point in a solid. Triangles of the shell `without` are passed over; -1: none are.
[[nodiscard]] PointPlace place_in(const PosedSolids& solids, Body solid, const PosedPoint& point,
                                  std::int32_t without = -1);

/// True if a closed triangle holds a point of its plane.
[[nodiscard]] bool holds_in_plane(const PosedSolids& solids, const PosedTriangle& triangle, const PosedPoint& point);
/// An axis along which the triangle's shadow has an area.
[[nodiscard]] int shadow_axis(const PosedSolids& solids, const PosedTriangle& triangle);

/// A triangle of a shell that is no part of the solid's boundary as it lies: a cavity that is in no part, or a part
/// that lies inside of a part. Nothing where there is none.
[[nodiscard]] std::optional<std::int32_t> misplaced_shell(const MeshSolid& solid);

}  // namespace pd::detail
