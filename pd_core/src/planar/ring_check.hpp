/// @file
/// Do rings cross, overlap, or lie where they must not, and where do they touch? A plane sweep (Shamos and Hoey,
/// "Geometric intersection problems", 1976) on exact orientation signs, in time O(n log n).
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
  enum class Kind { crossing, overlapping, touching, meeting, hole_outside, hole_in_hole, cut_in_two } kind;
  int edge;        ///< by its first vertex; where vertices meet and of holes, the vertex
  int other_edge;  ///< -1 where there is none
};

/// A vertex of another ring inside an edge.
struct RingTouch {
  int edge;
  int vertex;
};

struct RingCheck {
  std::optional<RingFault> fault;  ///< the first one along the sweep
  std::vector<RingTouch> touches;  ///< along the sweep
  bool shared_points = false;      ///< vertices of different rings coincide, or there are touches
};

[[nodiscard]] RingCheck check_rings(const Rings& rings);

/// A direction from a point where rings touch: along the edge that leaves it, or back along the one that arrives.
struct RingDirection {
  int vertex;  ///< of the corner; of an edge that passes, its first vertex
  Point2 to;
  bool out;
};
/// Sorts directions counter-clockwise, beginning just after straight down. Those on one line stay side by side.
void sort_around(const Point2& centre, std::vector<RingDirection>& directions);

}  // namespace pd::detail
