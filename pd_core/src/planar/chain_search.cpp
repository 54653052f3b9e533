#include "planar/chain_search.hpp"

#include <utility>

namespace pd::detail {

namespace {

/// The edges of P, or of -Q, that face along d: counter-clockwise from the vertex least along d's left normal to the
/// greatest. Their steps along that normal are positive, so that their order by angle is the order of turns.
struct Chain {
  const ConvexPolygon* polygon;
  double sign;
  int first;  ///< vertex
  int size;   ///< edges

  [[nodiscard]] int vertex(int k) const { return (first + k) % polygon->num_vertices(); }
  [[nodiscard]] PolygonEdge edge(int k) const { return edge_of(*polygon, vertex(k), sign); }
};

/// From the vertex farthest on the right of d to the one farthest on its left.
Chain facing(const ConvexPolygon& polygon, double sign, const Point2& left, int right_vertex, int left_vertex) {
  const Point2 up{sign * left[0], sign * left[1]};
  Chain chain{&polygon, sign, right_vertex, 0};
  // An edge across: its far end leads on to d's side.
  if (along(edge_of(polygon, chain.first, 1), up) == 0) chain.first = next_vertex(polygon, chain.first);
  chain.size = (left_vertex - chain.first + polygon.num_vertices()) % polygon.num_vertices();
  return chain;
}

}  // namespace

// -Q is least where Q is greatest.
SideVertices::SideVertices(const ConvexPolygon& p, const ConvexPolygon& q, const Point2& d, std::int64_t& probes)
    : p_right(p.extreme({d[1], -d[0]}, &probes)),
      p_left(p.extreme({-d[1], d[0]}, &probes)),
      q_right(q.extreme({d[1], -d[0]}, &probes)),
      q_left(q.extreme({-d[1], d[0]}, &probes)) {}

SideVertices SideVertices::turned() const {
  SideVertices r = *this;
  std::swap(r.p_right, r.p_left);
  std::swap(r.q_right, r.q_left);
  return r;
}

std::optional<ExitEdge> find_exit(const ConvexPolygon& p, const ConvexPolygon& q, const Point2& y, const Point2& d,
                                  const SideVertices& sides, std::int64_t& probes) {
  const Point2 left{-d[1], d[0]};
  const Chain cp = facing(p, 1, left, sides.p_right, sides.p_left);
  const Chain cq = facing(q, -1, left, sides.q_left, sides.q_right);
  probes += 2;
  // Sign of the height of R's vertex (i, j) over the line.
  const auto height = [&](int i, int j) {
    ++probes;
    return offset_along(p.vertex(cp.vertex(i)), q.vertex(cq.vertex(j)), y, left);
  };
  const int bottom = height(0, 0), top = height(cp.size, cq.size);
  if (bottom > 0 || top < 0) return std::nullopt;
  ExitEdge exit;
  exit.grazes = bottom == 0 || top == 0;
  // The wanted edge leads from a vertex not above the line to one above it (on it, where the line grazes the top); it
  // is one of P's edges [pl, pr) or of Q's [ql, qr), and what was dropped on the left comes before it in slope order.
  int pl = 0, pr = cp.size, ql = 0, qr = cq.size;
  const auto is_above = [&](int i, int j) { return top == 0 ? i == cp.size && j == cq.size : height(i, j) > 0; };
  while (pl < pr && ql < qr) {
    const int i = pl + (pr - pl) / 2, j = ql + (qr - ql) / 2;
    ++probes;
    if (turn(cp.edge(i), cq.edge(j)) >= 0) {
      // P's comes first: R has passed vertex (i + 1, at most j) behind it and (at least i + 1, j) before Q's.
      is_above(i + 1, j) ? qr = j : pl = i + 1;
    } else {
      is_above(i, j + 1) ? pr = i : ql = j + 1;
    }
  }
  // One polygon's share is known: its vertex stays while the other's edges pass.
  while (pr - pl > 1 && ql == qr) {
    const int i = pl + (pr - pl) / 2;
    is_above(i, ql) ? pr = i : pl = i;
  }
  while (qr - ql > 1 && pl == pr) {
    const int j = ql + (qr - ql) / 2;
    is_above(pl, j) ? qr = j : ql = j;
  }
  const bool of_p = pl < pr;
  exit.edge = of_p ? cp.edge(pl) : cq.edge(ql);
  exit.parts.vertex_p = cp.vertex(pl);
  exit.parts.vertex_q = cq.vertex(ql);
  (of_p ? exit.parts.edge_of_p : exit.parts.edge_of_q) = of_p ? cp.vertex(pl) : cq.vertex(ql);
  // A parallel edge of the other polygon stands beside it in slope order.
  const Chain& other = of_p ? cq : cp;
  const int at = of_p ? ql : pl;
  for (const int k : {at - 1, at}) {
    if (k < 0 || k >= other.size) continue;
    ++probes;
    if (turn(exit.edge, other.edge(k)) != 0) continue;
    (of_p ? exit.parts.edge_of_q : exit.parts.edge_of_p) = other.vertex(k);
    (of_p ? exit.parts.vertex_q : exit.parts.vertex_p) = other.vertex(k);
  }
  return exit;
}

}  // namespace pd::detail
