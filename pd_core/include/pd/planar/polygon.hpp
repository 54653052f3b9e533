/// @file
/// A polygon with holes, checked once: simple rings, every hole inside the outer ring.
///
/// The polygon is the closed region between its rings. Rings come in either orientation, their first point not
/// repeated; duplicate and collinear vertices are merged. Different rings may touch in single points as long as the
/// interior stays connected (OGC simple features). Rings that cross, overlap, touch themselves or fold back are refused
/// with the edges at fault, decided on the stored numbers exactly.
///
/// A vertex stands for a corner of the interior. If rings touch at a point, it has several vertices, one for each part
/// of the interior that meets there; an edge that is touched in its middle is two edges on one line.
///
/// [D] Dobkin, Hershberger, Kirkpatrick, Suri, "Computing the intersection-depth of polyhedra", 1993, section 4.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "pd/numeric/expected.hpp"
#include "pd/planar/contact.hpp"

namespace pd {

namespace detail {
struct RingLinks;
}

class Polygon {
 public:
  /// A vertex as the caller numbered it: ring -1 is the outer one, ring h >= 0 is `holes[h]`.
  struct VertexId {
    std::int32_t ring;
    std::int32_t index;
    friend bool operator==(const VertexId&, const VertexId&) = default;
  };

  /// Checks and normalises. Time O(n log n).
  /// @return ErrorCode::non_finite, out_of_range (above 1e300), too_few_points (fewer than 3 distinct points in a
  /// ring),
  ///         not_full_dimensional (a ring on one line), or bad_value for a ring that crosses or overlaps itself or
  ///         another one, touches itself, folds back, or is no hole of the outer ring, and for rings that touch so
  ///         that they cut the interior in two. `where` names the edge by its first point in the caller's order:
  ///         "outer[3]", "holes[0][2]".
  static Expected<Polygon> from_rings(std::span<const Point2> outer, std::span<const std::vector<Point2>> holes = {});

  /// A single point: the middle of a disc, whose radius is the margin of a swept question (PlanarMargins).
  /// @return non_finite or out_of_range as above.
  static Expected<Polygon> at_point(const Point2& point);
  [[nodiscard]] bool is_point() const { return points_.size() == 1; }

  [[nodiscard]] int num_vertices() const { return static_cast<int>(points_.size()); }
  [[nodiscard]] int num_rings() const { return static_cast<int>(ring_start_.size()) - 1; }
  /// All vertices, ring after ring: the outer one counter-clockwise, then the holes clockwise (the interior is on the
  /// left of every edge), each from its lexicographically least vertex; holes in the order of those.
  [[nodiscard]] std::span<const Point2> points() const { return points_; }
  [[nodiscard]] int ring_begin(int ring) const { return ring_start_[static_cast<std::size_t>(ring)]; }
  [[nodiscard]] int ring_end(int ring) const { return ring_start_[static_cast<std::size_t>(ring) + 1]; }
  [[nodiscard]] const Point2& point(int vertex) const { return points_[static_cast<std::size_t>(vertex)]; }
  /// Neighbours along the boundary. If rings touch, the corner that follows may belong to another ring.
  [[nodiscard]] int next(int vertex) const { return next_[static_cast<std::size_t>(vertex)]; }
  [[nodiscard]] int previous(int vertex) const { return previous_[static_cast<std::size_t>(vertex)]; }
  /// 1: convex corner of the interior, -1: reflex. 0 only where rings touch.
  [[nodiscard]] int turn(int vertex) const { return turn_[static_cast<std::size_t>(vertex)]; }
  [[nodiscard]] VertexId caller_id(int vertex) const { return caller_id_[static_cast<std::size_t>(vertex)]; }
  /// The edge from a vertex to the next, by the end that comes first in the caller's order: where the caller's ring was
  /// turned round, that is the next vertex.
  [[nodiscard]] VertexId caller_edge(int vertex) const { return caller_edge_[static_cast<std::size_t>(vertex)]; }
  /// Another vertex at the same point if rings touch there, else `vertex`. Repeated calls go through all of them.
  [[nodiscard]] int next_here(int vertex) const {
    return next_here_.empty() ? vertex : next_here_[static_cast<std::size_t>(vertex)];
  }
  /// The least vertex at the same point.
  [[nodiscard]] int first_here(int vertex) const {
    int first = vertex;
    for (int v = next_here(vertex); v != vertex; v = next_here(v)) first = v < first ? v : first;
    return first;
  }
  [[nodiscard]] bool convex() const { return convex_; }

 private:
  /// The corners where rings touch.
  void take(detail::RingLinks links);

  std::vector<Point2> points_;
  std::vector<std::int32_t> ring_start_, next_, previous_;
  std::vector<std::int8_t> turn_;
  std::vector<std::int32_t> next_here_;  ///< empty where no rings touch
  std::vector<VertexId> caller_id_, caller_edge_;
  bool convex_ = false;
};

}  // namespace pd
