/// @file
/// Lays a hull out in the memory that a ConvexPolytope shares: one block, and one for its table of directions.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "pd/shape/convex_polytope.hpp"
#include "shape/hull/facet_loops.hpp"

namespace pd::detail {

struct HullVertex {
  double x, y, z;
  std::int32_t caller_id;
};

/// @param vertices  the vertices, distinct, in any order.
/// @param loops  facets of a solid or of a doubly covered polygon, as loops of positions in `vertices`; none for a
/// segment or a point. The result depends on the polytope only, not on the order of vertices or facets: vertices in
/// lexicographic order, neighbours counter-clockwise from the lowest, facets by their lowest vertex and its successor.
/// Time O(n log n).
[[nodiscard]] std::shared_ptr<const ConvexPolytope::Storage> lay_out(std::span<const HullVertex> vertices,
                                                                     const FacetLoops& loops, int affine_dimension);

/// The same of a box along the axes, whose corner i is on the upper side of axis k where bit k of i is set.
[[nodiscard]] std::shared_ptr<const ConvexPolytope::Storage> lay_out_box(std::span<const HullVertex, 8> corners);

/// The same body times 2^exponent: connectivity, normals and the table of directions are copied. Null where a
/// coordinate would be rounded. Time O(n).
[[nodiscard]] std::shared_ptr<const ConvexPolytope::Storage> scaled_exactly(const ConvexPolytope::Storage& body,
                                                                            int exponent);

/// The outward unit normal of the plane of three points in counter-clockwise order: relative error a few ulp however
/// flat the triangle, at any magnitude. Requires that they are not collinear.
[[nodiscard]] Vec3 plane_normal(const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace pd::detail
