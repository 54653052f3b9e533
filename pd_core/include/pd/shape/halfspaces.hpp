/// @file
/// A solid given by the halfspaces that it is the intersection of ([D] section 5, footnote 1: bounded ones).
///
/// [D] Dobkin, Hershberger, Kirkpatrick, Suri, "Computing the intersection-depth of polyhedra", 1993.
#pragma once

#include <span>

#include "pd/numeric/expected.hpp"
#include "pd/numeric/vector.hpp"
#include "pd/shape/convex_polytope.hpp"

namespace pd {

/// The points x with <normal, x> <= offset.
struct Halfspace3 {
  Vec3 normal;
  double offset;
};

/// The vertices of the intersection, each the exact common point of three planes rounded to the nearest doubles, and
/// their hull. Which planes bound the body and which three meet in a vertex is decided by exact signs; redundant and
/// repeated halfspaces change nothing. Caller ids are the vertices' own order (lexicographic).
///
/// A body is called unbounded where it reaches farther than 2^46 times the largest offset / |normal|.
/// @param planes  4 to 2^13 of them; normals and offsets from 1e-100 to 1e100, offsets may be 0.
/// @return ErrorCode::too_few_points, limit_exceeded ("planes"); non_finite, out_of_range, zero_direction
/// ("planes[i]");
///         unbounded, bad_value (no point in common, or no interior in a segment or point), not_full_dimensional (a
///         polygon without thickness).
/// Time O(n^2) for n planes: each facet is cut by every other plane, most of which a box in doubles tells away.
[[nodiscard]] Expected<ConvexPolytope> polytope_of_halfspaces(std::span<const Halfspace3> planes);

}  // namespace pd
