/// @file
/// Convex polygons, and the Minkowski difference R = P + (-Q) of two of them ([D] section 3, Theorem 3.1).
///
/// With Q displaced by y, int P and int(Q + y) meet exactly when y lies inside R ([D] Lemma 2.1).
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "pd/numeric/expected.hpp"
#include "pd/planar/contact.hpp"

namespace pd {

/// Immutable: the vertices counter-clockwise from the lexicographically least, no three on a line.
class ConvexPolygon {
 public:
  /// The convex hull of the points, exact: interior points, duplicates and points on edges are dropped. So polygons
  /// come in either orientation.
  /// @return ErrorCode::too_few_points (none), non_finite or out_of_range (above 1e300; "points[i]"),
  ///         not_full_dimensional (all on one line). Time O(n log n); O(n) exact signs.
  static Expected<ConvexPolygon> from_points(std::span<const Point2> points);

  [[nodiscard]] int num_vertices() const { return static_cast<int>(points_.size()); }
  [[nodiscard]] std::span<const Point2> points() const { return points_; }
  [[nodiscard]] const Point2& vertex(int i) const { return points_[static_cast<std::size_t>(i)]; }
  /// The caller's index of a vertex, the lowest of duplicates.
  [[nodiscard]] int caller_id(int i) const { return caller_ids_[static_cast<std::size_t>(i)]; }

  /// The first of the vertices that maximise <v, direction>, counter-clockwise, exact. O(log n) signs.
  /// @param probes  counted up by the vertices or edges looked at, when given.
  [[nodiscard]] int extreme(const Point2& direction, std::int64_t* probes = nullptr) const;

  /// For searches: entry k is the first edge, by the vertex that it leaves, at or after direction k of a grid of size()
  /// - 1 directions (src/planar/angle_grid.hpp); the last entry is num_vertices(). Empty for small polygons. 2 to 4
  /// bytes a vertex.
  [[nodiscard]] std::span<const std::int32_t> first_edges() const { return first_edges_; }

 private:
  void tabulate_edges();

  std::vector<Point2> points_;
  std::vector<std::int32_t> caller_ids_;
  std::vector<std::int32_t> first_edges_;
};

/// R = P + (-Q) in terms of its summands, so that nothing is rounded. Vertex i is P's vertex `p` minus Q's vertex `q`,
/// and the edge from it is P's edge from p, -Q's from q, or both, exactly parallel and fused.
struct ConvexDifference {
  struct Corner {
    std::int32_t p;
    std::int32_t q;
    bool edge_of_p;
    bool edge_of_q;
  };
  /// Counter-clockwise, in slope order from the edge that leaves the lexicographically least vertex.
  std::vector<Corner> corners;
};

/// Edges merged in slope order. Time O(n + m); one exact sign an edge.
[[nodiscard]] ConvexDifference convex_difference(const ConvexPolygon& p, const ConvexPolygon& q);

}  // namespace pd
