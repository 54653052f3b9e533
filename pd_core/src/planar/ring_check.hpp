/// @file
/// Do rings cross, touch, or lie where they must not? A plane sweep (Shamos and Hoey, "Geometric intersection
/// problems", 1976) on exact orientation signs, in time O(n log n).
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "pd/planar/polygon.hpp"

namespace pd::detail {

/// Points in the lexicographic order of the sweep.
inline bool before(const Point2& a, const Point2& b) { return a < b; }

/// Rings of one polygon in flat form: the interior on the left of every edge, ring 0 the outer one.
struct Rings {
  std::span<const Point2> points;
  std::span<const std::int32_t> next, previous;
  std::span<const std::int32_t> ring;  ///< of every vertex
};

struct RingFault {
  enum class Kind { crossing, touching, meeting, hole_outside, hole_in_hole } kind;
  int edge;        ///< by its first vertex; where vertices meet and of holes, the vertex
  int other_edge;  ///< -1 where there is none
};

/// The first fault along the sweep, or nothing when the rings bound a polygon.
[[nodiscard]] std::optional<RingFault> find_ring_fault(const Rings& rings);

}  // namespace pd::detail
