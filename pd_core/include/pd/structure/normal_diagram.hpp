/// @file
/// The normal diagram (Gaussian map) of a convex polytope: the unit sphere cut into the cells of equal support.
///
/// Facet f is the point normal(f). The edge of half-edge h is the great arc between the normals of its two facets.
/// Vertex v is the convex cell of the directions in which v is extreme, its corners the normals of the facets round v.
/// It needs no storage beside the polytope's own: this is its vocabulary, and the location of a direction in it.
///
/// [A] Agarwal, Guibas, Har-Peled, Rabinovitch, Sharir, "Penetration depth of two convex polytopes in 3D", 2000, 2.2.
#pragma once

#include <cstdint>

#include "pd/numeric/vector.hpp"
#include "pd/shape/convex_polytope.hpp"

namespace pd {

/// A view: refers to the polytope, which must outlive it.
class NormalDiagram {
 public:
  /// The arc of an edge; as a normal goes from `from` to `to` it turns about the half-edge's direction.
  struct Arc {
    std::int32_t from;        ///< facet to the left of the half-edge
    std::int32_t to;          ///< facet to its right
    std::int32_t left_cell;   ///< vertex whose cell lies to the left of the arc: the half-edge's target
    std::int32_t right_cell;  ///< its origin
  };

  explicit NormalDiagram(const ConvexPolytope& polytope) : polytope_(&polytope) {}

  [[nodiscard]] int num_points() const { return polytope_->num_facets(); }
  [[nodiscard]] int num_arcs() const { return polytope_->num_edges(); }
  [[nodiscard]] int num_cells() const { return polytope_->num_vertices(); }

  /// Unit normal, rounded; the polytope's own frame.
  [[nodiscard]] const Vec3& point(int facet) const { return polytope_->facet_normal(facet); }
  /// Requires a polytope with facets (a segment's diagram is one great circle without ends).
  [[nodiscard]] Arc arc(int half_edge) const {
    const HalfEdge h = polytope_->half_edge(half_edge);
    return {h.facet, polytope_->half_edge(h.twin).facet, polytope_->target(half_edge), h.origin};
  }
  /// The k-th corner of a cell, counter-clockwise, k < neighbours(vertex).size(): a facet.
  [[nodiscard]] int corner(int vertex, int k) const {
    return polytope_->half_edge(polytope_->first_half_edge(vertex) + k).facet;
  }

  /// The cell that a direction lies in: the lowest vertex that attains max <v, direction>, exactly. Requires a finite
  /// direction other than zero, in the polytope's frame.
  /// Time: hill climbing from a table of directions, a few steps on round bodies, and exact signs for ties only.
  [[nodiscard]] int locate(const Vec3& direction) const;

 private:
  const ConvexPolytope* polytope_;
};

}  // namespace pd
