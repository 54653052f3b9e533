/// @file
/// The edge of R = P + (-Q) that a line leaves R through, found in P and Q at once ([D] section 3).
#pragma once

#include <optional>

#include "pd/planar/convex_depth.hpp"
#include "planar/convex_signs.hpp"

namespace pd::detail {

/// A vertex of R: one of P minus one of Q.
struct VertexOfDifference {
  int p, q;
};

/// One edge of R that faces along d.
struct ExitEdge {
  DifferenceEdge parts;
  PolygonEdge edge;
  bool grazes = false;  ///< the line only touches R
  /// Vertices of R on the right of the line and on its left (or on it, where it grazes), between which the edge was
  /// searched for; and one about as far behind them as the edge is ahead, or one of the two.
  VertexOfDifference right{}, left{}, back{};
};

/// The vertices of P and of Q that are least and greatest along d's left normal.
struct SideVertices {
  int p_right, p_left, q_right, q_left;
  SideVertices(const ConvexPolygon& p, const ConvexPolygon& q, const Point2& d, std::int64_t& probes);
  /// Those of -d.
  [[nodiscard]] SideVertices turned() const;
};

/// For the line through y along d; empty where it misses R. Of two edges that meet on the line the first
/// counter-clockwise, but at the last corner of a grazed R the last.
[[nodiscard]] std::optional<ExitEdge> find_exit(const ConvexPolygon& p, const ConvexPolygon& q, const Point2& y,
                                                const Point2& d, const SideVertices& sides, std::int64_t& probes);
/// The same from vertices that the polygons' tables know at a few directions, all soon in a cache: nothing where a
/// polygon has no table, or the line does not pass between them, and has to be asked about from the sides.
[[nodiscard]] std::optional<ExitEdge> find_exit_by_tables(const ConvexPolygon& p, const ConvexPolygon& q,
                                                          const Point2& y, const Point2& d, std::int64_t& probes);

/// y + t d lies on the edge's line for t = numerator / denominator, denominator > 0.
template <class N>
std::array<N, 2> crossing_time(const ConvexPolygon& p, const ConvexPolygon& q, const ExitEdge& exit, const Point2& y,
                               const Point2& d) {
  const auto u = vector_of<N>(exit.edge);
  const auto x = offset_of<N>(p.vertex(exit.parts.vertex_p), q.vertex(exit.parts.vertex_q), y);
  return {x[0] * u[1] - x[1] * u[0], N(d[0]) * u[1] - N(d[1]) * u[0]};
}

}  // namespace pd::detail
