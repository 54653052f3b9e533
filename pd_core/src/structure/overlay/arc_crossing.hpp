/// @file
/// Whether the arcs of an edge of B and of an edge of -A cross in the overlay of the two normal diagrams, decided by
/// four exact signs: the pair of edges then is an edge-edge facet of P ([A] section 2.2), the very pieces that
/// `OverlayWalk` meets.
#pragma once

#include <optional>

#include "structure/overlay/overlay_walk.hpp"

namespace pd::detail {

/// The piece of two edges (any of their half-edges) when their arcs cross, A turned by infinitely little where they
/// only meet.
///
/// The arc of a half-edge e runs from its left facet's normal L to its right one's R, turning about e. With n = s (b x
/// a), s = 1 or -1, det(b, L, n) = s |b|^2 <a, L>: n lies inside the arc of b exactly when s <a, L_b> > 0 > s <a, R_b>,
/// and -n inside that of a when s <b, L_a> > 0 > s <b, R_a>. A segment's arc is a whole great circle.
inline std::optional<OverlayPiece> edge_crossing(const OverlayWalk& walk, int half_edge_a, int half_edge_b) {
  const ConvexPolytope& body_a = walk.pair().a();
  const ConvexPolytope& body_b = walk.pair().b();
  const HalfEdge a = body_a.half_edge(half_edge_a);
  const HalfEdge b = body_b.half_edge(half_edge_b);
  int s = 0;
  if (b.facet >= 0) {
    s = walk.side_of_edge_a(half_edge_a, b.facet);
    if (walk.side_of_edge_a(half_edge_a, body_b.half_edge(b.twin).facet) == s) return std::nullopt;
  }
  if (a.facet >= 0) {
    const int left = walk.side_of_edge_b(half_edge_b, a.facet);
    if (s != 0 && left != s) return std::nullopt;
    if (walk.side_of_edge_b(half_edge_b, body_a.half_edge(a.twin).facet) == left) return std::nullopt;
    s = left;
  }
  if (s == 0) return std::nullopt;  // two segments: P has no facets to speak of
  return OverlayPiece{OverlayPiece::Kind::edges, s > 0 ? half_edge_a : a.twin, half_edge_b};
}

}  // namespace pd::detail
