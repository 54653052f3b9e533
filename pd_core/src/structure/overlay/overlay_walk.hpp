/// @file
/// The overlay of the normal diagrams of B and -A, walked: every facet of P = B + (-A), without building P.
///
/// The normal diagram (Gaussian map) of a polytope X maps each facet to the point of the unit sphere that is its
/// normal, each edge to the arc between the normals of its two facets, each vertex to the convex cell of the normals of
/// its supporting planes. A direction n is normal to a facet of P exactly when it is a vertex of the overlay ([A]
/// section 2): the normal of a facet of B, the negative normal of a facet of A, or the crossing of two arcs.
///
/// One predicate decides everything: on which side of an edge's great circle a facet normal of the other body lies,
/// sign <e, n> = det(e, u, v) with two vectors u, v of the facet. A crossing needs no normal of normals, since the
/// great circle of an edge of Y leaves a cell of X through the arc whose ends lie on different sides of it.
///
/// Degenerate positions (<e, n> = 0: coplanar facets, parallel edges, an edge in the plane of a facet) are those of A
/// turned by the rotation exp(omega(t)), omega(t) = t w + t^1.3 y + t^1.6 z with t > 0 arbitrarily small: then <e, n>
/// changes by <omega, e x n> up to O(t^2), and e x n is not zero since e is orthogonal to n, so that one of the three
/// terms decides. The overlay is that of a true pair in general position; where facets of A and B are parallel, or
/// edges lie in each other's facets, it cuts the one facet of P into pieces with one and the same plane. Pieces with
/// two exactly parallel edges have no area and no plane; the receiver skips them.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "shape/posed_pair.hpp"
#include "structure/overlay/facet_of_difference.hpp"
#include "structure/overlay/posed_diagram.hpp"

namespace pd::detail {

/// A vertex of the overlay.
struct OverlayPiece {
  enum class Kind : std::int32_t {
    facet_of_a,  ///< a = facet, b = vertex
    facet_of_b,  ///< a = vertex, b = facet
    edges,       ///< a, b = half-edges, directed so that (edge of b) x (edge of a) points out of P
  };
  Kind kind;
  std::int32_t a;
  std::int32_t b;
};

/// What the finishing step needs of a piece.
[[nodiscard]] FacetOfDifference facet_of(const PosedPair& pair, const OverlayPiece& piece);

/// Owned by the caller, grown on first use, never shrunk.
struct OverlayBuffers {
  static constexpr std::size_t kBlock = 256;
  struct Visit {
    std::int32_t facet;
    std::int32_t start;
    std::int32_t next;
  };
  PosedDiagram a;
  PosedDiagram b;
  std::vector<Visit> visits;
  std::array<OverlayPiece, kBlock> block;
};

/// The walk for one posed pair. Time O(m + n + K deg) for m and n edges, K pieces and vertices of degree deg (a
/// crossing costs log deg only; a facet located in a cell costs all its sides, which shows for apexes of thousands of
/// edges); the constant does not depend on the shapes' position except where exact arithmetic decides.
class OverlayWalk {
 public:
  OverlayWalk(const PosedPair& pair, OverlayBuffers& buffers);

  /// Calls `consume(std::span<const OverlayPiece>)` with blocks of pieces, each piece of P once, until all are out or
  /// it returns false. Returns whether all went out. None for two bodies without facets (points and segments).
  template <class Consume>
  bool run(Consume&& consume) {
    sink_ = [](void* context, std::span<const OverlayPiece> pieces) -> bool {
      return (*static_cast<std::remove_reference_t<Consume>*>(context))(pieces);
    };
    context_ = &consume;
    return run_all();
  }

  /// Side of the great circle of an edge (half-edge of A) on which a facet normal of B lies; 0 only when `symbolic` is
  /// false.
  [[nodiscard]] int side_of_edge_a(int half_edge_a, int facet_b, bool symbolic = true) const;
  /// The same with an edge of B and a facet of A (its own outward normal).
  [[nodiscard]] int side_of_edge_b(int half_edge_b, int facet_a, bool symbolic = true) const;

  [[nodiscard]] const PosedPair& pair() const { return *pair_; }
  [[nodiscard]] const OverlayBuffers& buffers() const { return *buffers_; }

 private:
  struct Side;  // one body and its role

  bool run_all();
  bool walk_segment(const Side& segment, const Side& other);
  void locate_facets(const Side& moving, const Side& fixed);
  bool walk_arcs(const Side& moving, const Side& fixed);
  int side(const Side& edge_body, int half_edge, const Side& facet_body, int facet) const;
  int decide_exactly(bool edge_of_a, int half_edge, int facet, bool symbolic) const;
  bool emit(const Side& moving, std::int32_t of_moving, std::int32_t of_fixed, OverlayPiece::Kind kind);
  bool emit(OverlayPiece::Kind kind, std::int32_t a, std::int32_t b);
  bool flush();

  const PosedPair* pair_;
  OverlayBuffers* buffers_;
  bool (*sink_)(void*, std::span<const OverlayPiece>) = nullptr;
  void* context_ = nullptr;
  std::size_t filled_ = 0;
};

}  // namespace pd::detail
