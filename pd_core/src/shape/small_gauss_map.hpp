/// @file
/// The Gauss map (normal diagram) of a solid of few vertices as arrays: facets' normals are its points, edges its arcs.
/// For kernels that try all facets and edges of two bodies against each other (depth/facets/small_sat.hpp).
#pragma once

#include <cstdint>

#include "pd/shape/convex_polytope.hpp"

namespace pd::detail {

/// Lanes beyond the last facet repeat the first.
struct SmallGaussMap {
  // Euler: F <= 2 V - 4, E <= 3 V - 6.
  static constexpr int kMostVertices = 8;
  static constexpr int kMostFacets = 12;
  static constexpr int kMostEdges = 18;
  static constexpr int kFacetGroup = 4;

  /// Outward, as `ConvexPolytope::facet_normal`, and their product with a vertex of the facet.
  alignas(32) double nx[kMostFacets], ny[kMostFacets], nz[kMostFacets], height[kMostFacets];
  /// A set of facets as the edges whose left facet is in it, and 32 bits higher those whose right one is: entry g holds
  /// that of each set of facets 4 g to 4 g + 3, by its bits.
  std::uint64_t edges_of_facets[kMostFacets / kFacetGroup][1 << kFacetGroup];
  std::uint8_t from[kMostEdges], to[kMostEdges];     ///< an edge's vertices
  std::uint8_t left[kMostEdges], right[kMostEdges];  ///< its facets, as seen along it from outside
  std::uint8_t on_facet[kMostFacets];                ///< a vertex of it
  std::uint8_t facets, edges;
  double inner_radius;  ///< of a ball round the body's centre that it holds, rounded down
};

/// What the hull builder lays out for solids of at most `kMostVertices` vertices.
struct SmallBodyStorage : ConvexPolytope::Storage {
  SmallGaussMap gauss_map;
};

/// Whether a body has one.
inline bool has_small_gauss_map(int affine_dimension, int vertices) {
  return affine_dimension == 3 && vertices <= SmallGaussMap::kMostVertices;
}
inline bool has_small_gauss_map(const ConvexPolytope& p) {
  return has_small_gauss_map(p.affine_dimension(), p.num_vertices());
}

/// Requires `has_small_gauss_map`.
inline const SmallGaussMap& small_gauss_map(const ConvexPolytope& p) {
  return static_cast<const SmallBodyStorage&>(p.storage()).gauss_map;
}

/// Fills it in from the arrays of a body that has them.
void fill_small_gauss_map(const ConvexPolytope::Storage& s, SmallGaussMap& out);

}  // namespace pd::detail
