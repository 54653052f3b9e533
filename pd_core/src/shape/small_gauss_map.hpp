/// @file
/// The Gauss map (normal diagram) of a solid of few vertices as arrays: facets' normals are its points, edges its arcs.
/// For kernels that try all facets and edges of two bodies against each other (depth/facets/gauss_sat.hpp).
#pragma once

#include <cstdint>

#include "pd/shape/convex_polytope.hpp"

namespace pd::detail {

/// An edge by its vertices, and the facets to its left and right, as seen along it from outside.
struct GaussEdge {
  std::uint8_t from, to, left, right;
};

/// Lanes beyond the last facet repeat the first.
struct SmallGaussMap {
  // Euler: F <= 2 V - 4, E <= 3 V - 6.
  static constexpr int kMostVertices = 8;
  static constexpr int kMostFacets = 12;
  static constexpr int kMostEdges = 18;
  static constexpr int kFacetSlots = 16;

  /// Outward, as `ConvexPolytope::facet_normal`, and their product with a vertex of the facet.
  alignas(32) double nx[kFacetSlots], ny[kFacetSlots], nz[kFacetSlots], height[kFacetSlots];
  GaussEdge edge[kMostEdges];
  std::uint8_t left[kMostEdges], right[kMostEdges];  ///< once more by edge
  std::uint8_t facets, edges;
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
