/// @file
/// A polytope's own proof: that its arrays describe one closed convex surface, in the canonical order.
#pragma once

#include <string>

#include "pd/shape/convex_polytope.hpp"

namespace pd {

/// Empty when everything holds, else the first thing that does not. Checked are the order of vertices, neighbours and
/// facets; half-edges, facet loops and adjacency against each other; Euler's formula. Every facet must be planar,
/// strictly convex and wound once, every edge strictly convex. Where that is at most `max_global_tests` tests, every
/// vertex below every facet. All signs are exact. Time O(n), and O(num_vertices * num_facets) for the last check.
[[nodiscard]] std::string verify_polytope(const ConvexPolytope& polytope, double max_global_tests = 1e7);

}  // namespace pd
