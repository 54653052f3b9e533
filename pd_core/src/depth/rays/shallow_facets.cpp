#include "depth/rays/shallow_facets.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "numeric/quotient.hpp"
#include "numeric/unit_roundoff.hpp"
#include "structure/overlay/face_sum.hpp"

namespace pd::detail {

namespace {

std::uint64_t key_of(const OverlayPiece& piece) {
  // Kinds are 0, 1, 2; ids below 2^31.
  return static_cast<std::uint64_t>(piece.kind) << 62 | static_cast<std::uint64_t>(piece.a) << 31 |
         static_cast<std::uint64_t>(piece.b);
}

PairVector edge_vector(bool of_a, int from, int to) {
  return of_a ? PairVector::edge_a(from, to) : PairVector::edge_b(from, to);
}

}  // namespace

ShallowSearch::ShallowSearch(const OverlayWalk& walk, double radius)
    : walk_(walk), pair_(walk.pair()), radius_(radius) {}

int ShallowSearch::side(bool edge_of_a, int half_edge, int facet) const {
  return edge_of_a ? walk_.side_of_edge_a(half_edge, facet) : walk_.side_of_edge_b(half_edge, facet);
}

/// Along the arc of a half-edge e, from its left facet's normal to its right one's, inside a cell of the other body:
/// the overlay's next vertex. The great circle of e leaves the cell through the arc k with <e, right normal of k> < 0 <
/// <e, left normal of k>; the arc of e ends before where its right facet's normal lies on the cell's side of k.
OverlayPiece ShallowSearch::follow(bool moves_a, int half_edge, int cell) {
  const ConvexPolytope& body = moves_a ? pair_.a() : pair_.b();
  const ConvexPolytope& other = moves_a ? pair_.b() : pair_.a();
  const int end = body.half_edge(body.half_edge(half_edge).twin).facet;
  const int first = other.first_half_edge(cell);
  const int count = static_cast<int>(other.neighbours(cell).size());
  ++steps_;
  int before = side(moves_a, half_edge, other.half_edge(other.half_edge(first).twin).facet);
  for (int k = first; k < first + count; ++k) {
    ++degrees_;
    const int after = side(moves_a, half_edge, other.half_edge(k).facet);
    if (before < 0 && after > 0) {
      if (side(!moves_a, k, end) < 0) {
        return moves_a ? OverlayPiece{OverlayPiece::Kind::edges, half_edge, k}
                       : OverlayPiece{OverlayPiece::Kind::edges, k, half_edge};
      }
      break;
    }
    before = after;
  }
  return moves_a ? OverlayPiece{OverlayPiece::Kind::facet_of_a, end, cell}
                 : OverlayPiece{OverlayPiece::Kind::facet_of_b, cell, end};
}

template <class Visit>
void ShallowSearch::for_each_neighbour(const OverlayPiece& piece, Visit&& visit) {
  const ConvexPolytope& a = pair_.a();
  const ConvexPolytope& b = pair_.b();
  const auto along_a = [&](int e, int cell) {
    visit(Neighbour{follow(true, e, cell), {{a.half_edge(e).origin, cell}, {a.target(e), cell}}});
  };
  const auto along_b = [&](int k, int cell) {
    visit(Neighbour{follow(false, k, cell), {{cell, b.half_edge(k).origin}, {cell, b.target(k)}}});
  };
  switch (piece.kind) {
    case OverlayPiece::Kind::facet_of_a: {
      const int first = a.facet_half_edge(piece.a);
      int e = first;
      do {
        along_a(e, piece.b);
        e = a.half_edge(e).next;
      } while (e != first);
      break;
    }
    case OverlayPiece::Kind::facet_of_b: {
      const int first = b.facet_half_edge(piece.b);
      int k = first;
      do {
        along_b(k, piece.a);
        k = b.half_edge(k).next;
      } while (k != first);
      break;
    }
    case OverlayPiece::Kind::edges:
      // e crosses from the cell of k's origin into that of its target, and k from that of e's origin into its target's.
      along_a(piece.a, b.target(piece.b));
      along_a(a.half_edge(piece.a).twin, b.half_edge(piece.b).origin);
      along_b(piece.b, a.target(piece.a));
      along_b(b.half_edge(piece.b).twin, a.half_edge(piece.a).origin);
  }
}

bool ShallowSearch::enqueue(const OverlayPiece& piece) {
  OverlayPiece canonical = piece;
  if (piece.kind == OverlayPiece::Kind::edges) {
    const int twin = pair_.a().half_edge(piece.a).twin;
    if (twin < piece.a) canonical = {piece.kind, twin, pair_.b().half_edge(piece.b).twin};
  }
  if (!seen_.insert(key_of(canonical)).second) return false;
  queue_.push_back(canonical);
  return true;
}

/// A facet of the body at this vertex that lies in the plane spanned by u and w, facing as a facet of P with the normal
/// u x w; -1 when there is none.
int ShallowSearch::facet_in_plane(bool of_a, int vertex, const PairVector& u, const PairVector& w) const {
  const ConvexPolytope& body = of_a ? pair_.a() : pair_.b();
  const Vec3 normal = pair_.approximate(u).cross(pair_.approximate(w));
  const Mat3& rotation = of_a ? pair_.pose_a().rotation() : pair_.pose_b().rotation();
  const int first = body.first_half_edge(vertex);
  for (int h = first; h < first + static_cast<int>(body.neighbours(vertex).size()); ++h) {
    const int f = body.half_edge(h).facet;
    const double facing = (rotation * body.facet_normal(f)).dot(normal);
    if ((of_a ? -facing : facing) <= 0) continue;
    const auto corner = FacetOfDifference::corners(body, f);
    if (pair_.sign_determinant(edge_vector(of_a, corner[0], corner[1]), u, w) == 0 &&
        pair_.sign_determinant(edge_vector(of_a, corner[0], corner[2]), u, w) == 0) {
      return f;
    }
  }
  return -1;
}

/// A half-edge from this vertex in the plane spanned by u and w; -1 when there is none.
int ShallowSearch::edge_in_plane(bool of_a, int vertex, const PairVector& u, const PairVector& w) const {
  const ConvexPolytope& body = of_a ? pair_.a() : pair_.b();
  const int first = body.first_half_edge(vertex);
  for (int h = first; h < first + static_cast<int>(body.neighbours(vertex).size()); ++h) {
    if (pair_.sign_determinant(edge_vector(of_a, vertex, body.target(h)), u, w) == 0) return h;
  }
  return -1;
}

/// A piece of the facet of P through three of its vertices: its face of A and its face of B meet the first vertex in a
/// facet, or in an edge each.
std::optional<OverlayPiece> ShallowSearch::piece_of(const std::array<VertexPair, 3>& corners) const {
  const VertexPair& at = corners[0];
  const PairVector u = PairVector::difference(at.a, at.b, corners[1].a, corners[1].b);
  const PairVector w = PairVector::difference(at.a, at.b, corners[2].a, corners[2].b);
  // The cell in which the symbolic rotation puts a facet's normal: exact signs tie on the face, the rotation parts
  // them.
  const auto locate = [&](bool in_a, int vertex, int facet) {
    const ConvexPolytope& body = in_a ? pair_.a() : pair_.b();
    for (bool improved = true; improved;) {
      improved = false;
      const int first = body.first_half_edge(vertex);
      for (int h = first; h < first + static_cast<int>(body.neighbours(vertex).size()); ++h) {
        if (side(in_a, h, facet) < 0) {
          vertex = body.target(h);
          improved = true;
          break;
        }
      }
    }
    return vertex;
  };
  if (const int g = facet_in_plane(false, at.b, u, w); g >= 0) {
    return OverlayPiece{OverlayPiece::Kind::facet_of_b, locate(true, at.a, g), g};
  }
  if (const int f = facet_in_plane(true, at.a, u, w); f >= 0) {
    return OverlayPiece{OverlayPiece::Kind::facet_of_a, f, locate(false, at.b, f)};
  }
  const int e = edge_in_plane(true, at.a, u, w), k = edge_in_plane(false, at.b, u, w);
  if (e < 0 || k < 0) return std::nullopt;
  const bool leaves = side(true, e, pair_.b().half_edge(k).facet) > 0;
  return OverlayPiece{OverlayPiece::Kind::edges, leaves ? e : pair_.a().half_edge(e).twin, k};
}

bool ShallowSearch::lies_in(const OverlayPiece& piece, const FacetOfDifference& plane) const {
  const FacetOfDifference facet = facet_of(pair_, piece);
  return pair_.sign_determinant(facet.u, plane.u, plane.v) == 0 &&
         pair_.sign_determinant(facet.v, plane.u, plane.v) == 0 &&
         pair_.sign_determinant(PairVector::difference(plane.a, plane.b, facet.a, facet.b), plane.u, plane.v) == 0;
}

void ShallowSearch::add_seed(const std::array<VertexPair, 3>& corners) {
  const std::optional<OverlayPiece> piece = piece_of(corners);
  if (!piece || !enqueue(*piece)) return;
  ++seeds_;
  const FacetOfDifference plane = facet_of(pair_, *piece);
  for (std::size_t i = queue_.size() - 1; i < queue_.size(); ++i) {
    const OverlayPiece from = queue_[i];
    for_each_neighbour(from, [&](const Neighbour& next) {
      if (lies_in(next.piece, plane)) enqueue(next.piece);
    });
  }
}

bool ShallowSearch::meets_ball(const Edge& edge) const {
  const Vec3 p = pair_.approximate(PairVector::point(edge.from.a, edge.from.b));
  const Vec3 q = pair_.approximate(PairVector::point(edge.to.a, edge.to.b));
  const Vec3 e = q - p;
  const double squared = e.squaredNorm();
  const double t = squared > 0 ? std::clamp(-p.dot(e) / squared, 0.0, 1.0) : 0.0;
  // Rounding may only let an edge in that lies a little outside.
  const double size = std::max(p.cwiseAbs().maxCoeff(), q.cwiseAbs().maxCoeff());
  return (p + t * e).norm() <= radius_ * (1 + 0x1p-40) + 4 * pair_.vector_error() + 32 * kUnitRoundoff * size;
}

void ShallowSearch::run() {
  for (; next_ < queue_.size(); ++next_) {
    const OverlayPiece from = queue_[next_];
    for_each_neighbour(from, [&](const Neighbour& next) {
      if (meets_ball(next.across)) enqueue(next.piece);
    });
  }
}

namespace {

struct NearPiece {
  OverlayPiece piece;
  double lower;  ///< of its plane's distance
};

/// The pieces that may be the nearest, by distances in doubles, each within its error: these leave out all but the near
/// ties.
std::vector<NearPiece> near_pieces(const PosedPair& pair, const std::vector<OverlayPiece>& pieces) {
  const double e = pair.vector_error();
  std::vector<NearPiece> near;
  double upper = std::numeric_limits<double>::infinity();
  for (const OverlayPiece& piece : pieces) {
    const FacetOfDifference facet = facet_of(pair, piece);
    const Vec3 u = pair.approximate(facet.u), v = pair.approximate(facet.v), p = pair.approximate(facet.point());
    const Vec3 n = u.cross(v);
    const double su = u.cwiseAbs().sum(), sv = v.cwiseAbs().sum(), sp = p.cwiseAbs().sum(), sn = n.cwiseAbs().sum();
    const double normal_error = (e * (su + sv + 2 * e) + 0x1p-51 * su * sv) * (1 + 0x1p-40);
    const double length = n.norm();
    const double least = length * (1 - 0x1p-50) - 2 * normal_error;
    if (!(least > 0)) {
      near.push_back({piece, 0});
      continue;
    }
    const double offset_error = (normal_error * (sp + 3 * e) + sn * e + 0x1p-50 * sp * sn) * (1 + 0x1p-40);
    const double distance = n.dot(p) / length;
    const double error = (offset_error + 2 * normal_error * std::abs(distance)) / least + 0x1p-48 * std::abs(distance);
    if (distance - error > upper) continue;
    upper = std::min(upper, distance + error);
    near.push_back({piece, distance - error});
  }
  std::erase_if(near, [&](const NearPiece& c) { return c.lower > upper; });
  return near;
}

}  // namespace

std::optional<FacetOfDifference> nearest_piece(const OverlayWalk& walk, const std::vector<OverlayPiece>& pieces) {
  const PosedPair& pair = walk.pair();
  const auto rank = [&](const OverlayPiece& piece) {
    const FacetOfDifference f = facet_of(pair, piece);
    return std::make_tuple(piece.kind, f.on_a.first, f.on_a.second, f.on_b.first, f.on_b.second);
  };
  std::optional<OverlayPiece> best;
  SquaredRatio best_squared;
  for (const NearPiece& candidate : near_pieces(pair, pieces)) {
    // A piece that only cuts another one's plane, or has no area, is not its facet's representative.
    if (candidate.piece.kind != OverlayPiece::Kind::facet_of_a && !whole_facet(walk, candidate.piece)) continue;
    const FacetOfDifference facet = facet_of(pair, candidate.piece);
    const Dyadic3 n = cross(pair.exact(facet.u), pair.exact(facet.v));
    const Dyadic offset = dot(pair.exact(facet.point()), n);
    const SquaredRatio squared{offset * offset, dot(n, n)};
    if (squared.denominator.sign() == 0) continue;
    int order = -1;
    if (best) {
      order = compare(squared, best_squared);
      if (order == 0 && rank(candidate.piece) < rank(*best)) order = -1;
    }
    if (order < 0) {
      best = candidate.piece;
      best_squared = squared;
    }
  }
  if (!best) return std::nullopt;
  return facet_of(pair, *best);
}

}  // namespace pd::detail
