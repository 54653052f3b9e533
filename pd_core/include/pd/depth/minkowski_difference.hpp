/// @file
/// The Minkowski difference P = B + (-A) = {b - a} of two posed polytopes, built: vertices and facets.
///
/// Combinatorics exact on the stored numbers and poses: two points are one vertex, and pieces of one plane one facet,
/// exactly when they are so in real arithmetic. From the overlay of the two normal diagrams ([A] section 2).
///
/// [A] Agarwal, Guibas, Har-Peled, Rabinovitch, Sharir, "Penetration depth of two convex polytopes in 3D", 2000.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "pd/numeric/expected.hpp"
#include "pd/numeric/vector.hpp"
#include "pd/shape/convex_polytope.hpp"
#include "pd/shape/feature.hpp"
#include "pd/shape/pose.hpp"

namespace pd {

/// A facet of P is the difference of a face of A and a face of B; A's is named first.
enum class DifferenceFacetKind : std::uint8_t {
  facet_vertex,
  vertex_facet,
  edge_edge,
  facet_edge,   ///< an edge of B lies in the plane of a facet of A
  edge_facet,   ///< an edge of A lies in the plane of a facet of B
  facet_facet,  ///< parallel facets
};

/// "facet-vertex", "edge-edge", ...
[[nodiscard]] std::string_view to_string(DifferenceFacetKind kind);

struct MinkowskiDifference {
  struct Vertex {
    Vec3 position;   ///< b - a in the common frame, each coordinate within an ulp of the exact one
    std::int32_t a;  ///< vertex ids (ConvexPolytope's numbering)
    std::int32_t b;
  };
  struct Facet {
    DifferenceFacetKind kind;
    Feature on_a;
    Feature on_b;
    Vec3 normal;         ///< outward, unit, rounded
    std::int32_t first;  ///< its corners are `corners[first .. first + count)`, counter-clockwise from outside
    std::int32_t count;
  };

  int affine_dimension = 3;
  std::vector<Vertex> vertices;  ///< ordered by (a, b); of a flat P of dimension 2: counter-clockwise about one side
  std::vector<Facet> facets;     ///< empty when P is flat
  std::vector<std::int32_t> corners;

  /// K, the number of facets.
  [[nodiscard]] std::int64_t num_facets() const { return static_cast<std::int64_t>(facets.size()); }
};

/// Builds P.
/// @param max_facets  pieces of the overlay that may be met; K can be of the order of (edges of A) x (edges of B).
/// @return ErrorCode::limit_exceeded beyond it.
/// Time O(m + n + K (deg + log K)), space O(K).
[[nodiscard]] Expected<MinkowskiDifference> minkowski_difference(const ConvexPolytope& a, const Pose& pose_a,
                                                                 const ConvexPolytope& b, const Pose& pose_b,
                                                                 std::int64_t max_facets = std::int64_t{1} << 24);

}  // namespace pd
