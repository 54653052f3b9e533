/// @file
/// One facet of P = B + (-A), or one piece of it, as the engines hand it to the finishing step: the two faces whose
/// difference it is, and its plane in exact terms.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "pd/shape/feature.hpp"
#include "shape/posed_pair.hpp"

namespace pd::detail {

/// The plane {point + s u + t v}. Exactly: u x v is not zero and points out of P, and h_P(u x v) = <point, u x v>.
struct FacetOfDifference {
  Feature on_a;  ///< vertex, edge or facet of A
  Feature on_b;  ///< vertex, edge or facet of B
  PairVector u;
  PairVector v;
  std::int32_t a = -1;  ///< the point b - a of P lies in the facet
  std::int32_t b = -1;

  [[nodiscard]] PairVector point() const { return PairVector::point(a, b); }

  /// R_B of the facet of B less a vertex of A.
  static FacetOfDifference from_facet_of_b(const ConvexPolytope& body_b, int facet, int vertex_a) {
    const auto corner = corners(body_b, facet);
    return {{Feature::Kind::vertex, vertex_a, -1},
            {Feature::Kind::facet, facet, -1},
            PairVector::edge_b(corner[0], corner[1]),
            PairVector::edge_b(corner[0], corner[2]),
            vertex_a,
            corner[0]};
  }
  /// A vertex of B less a facet of A: the outward normal is minus the facet's own.
  static FacetOfDifference from_facet_of_a(const ConvexPolytope& body_a, int facet, int vertex_b) {
    const auto corner = corners(body_a, facet);
    return {{Feature::Kind::facet, facet, -1},
            {Feature::Kind::vertex, vertex_b, -1},
            PairVector::edge_a(corner[0], corner[2]),
            PairVector::edge_a(corner[0], corner[1]),
            corner[0],
            vertex_b};
  }
  /// Edge against edge; directed so that (b1 - b0) x (a1 - a0) points out of P and is not zero.
  static FacetOfDifference from_edges(int a0, int a1, int b0, int b1) {
    return {{Feature::Kind::edge, std::min(a0, a1), std::max(a0, a1)},
            {Feature::Kind::edge, std::min(b0, b1), std::max(b0, b1)},
            PairVector::edge_b(b0, b1),
            PairVector::edge_a(a0, a1),
            a0,
            b0};
  }

  /// Three vertices far apart on the facet's loop, in its order: they span its plane exactly and well.
  static std::array<std::int32_t, 3> corners(const ConvexPolytope& body, int facet) {
    const auto loop = body.facet_vertices(facet);
    return {loop[0], loop[loop.size() / 3], loop[2 * loop.size() / 3]};
  }
};

}  // namespace pd::detail
