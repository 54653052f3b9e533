/// @file
/// An independent hull oracle: every plane through three points, in rationals. O(n^4), for small sets that span space.
#pragma once

#include <set>
#include <span>
#include <vector>

#include "pd/shape/convex_polytope.hpp"

namespace pd::test {

struct ExactHull {
  std::set<int> vertices;          ///< lowest caller index of each vertex
  std::set<std::set<int>> facets;  ///< as sets of vertices
};

[[nodiscard]] ExactHull exact_hull(std::span<const Vec3> points);

/// A polytope's combinatorics in the same terms.
[[nodiscard]] ExactHull combinatorics(const ConvexPolytope& polytope);

}  // namespace pd::test
