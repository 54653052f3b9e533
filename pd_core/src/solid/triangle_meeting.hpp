/// @file
/// How a triangle of one solid meets a triangle of another, exactly, and what that says about the solids' interiors.
///
/// Why these tests are enough. Let a point of A's surface lie in int B, and follow the surface from there. Either its
/// connected part lies in int B but for finitely many points, which the place of one of its points tells, or there is
/// an arc along which it leaves int B. A point of that arc lies inside a triangle of A or inside an edge, and inside a
/// triangle of B or inside an edge (all but finitely many do). So one of these pairs shows it: two triangles that
/// cross; an edge that runs in a triangle's plane, through the triangle; two edges that run along each other; and for
/// the surfaces that coincide, two triangles of one plane. Each is decided by the wedges of the two solids there.
#pragma once

#include <cstdint>

#include "solid/posed_solids.hpp"

namespace pd::detail {

enum class Meeting : std::uint8_t {
  apart,
  touch,    ///< common points, none of which says more
  arc,      ///< the surfaces run along each other there, with the interiors on opposite sides
  overlap,  ///< the solids have interior points in common near the meeting
};

/// True if two triangles lie in one plane and have an area in common.
[[nodiscard]] bool share_area(const PosedSolids& solids, const PosedTriangle& s, const PosedTriangle& t);

[[nodiscard]] Meeting meeting_of(const PosedSolids& solids, std::int32_t triangle_a, std::int32_t triangle_b);

}  // namespace pd::detail
