/// @file
/// Depth of two solids of at most 32 vertices and 64 facets that lie deep in each other, in doubles with a certificate:
/// all facets of P by their Gauss maps (all_facets_kernels.hpp), no search (Gregorius, "The separating axis test
/// between convex polyhedra", GDC 2013).
///
/// Deep in each other, nearly all facets of P are about as near, and a surface that grows inside P meets most of them,
/// one after the other: 26 steps for two hulls of 32 vertices. Why it proves anything: as small_sat.hpp, but that an
/// edge whose side single precision leaves open ends the attempt.
#pragma once

#include "depth/difference/bracket_width.hpp"
#include "depth/facets/near_facets.hpp"

namespace pd::detail {

/// Whether both bodies are solids of so few facets, more than small_sat.hpp takes.
[[nodiscard]] bool all_facets_apply(const ConvexPolytope& a, const ConvexPolytope& b);

/// Whether it is worth it, measured on hulls of 9 to 32 vertices: the bodies' centres are close to each other, and
/// neither is long or flat, nor far from its frame's origin. A surface needs 15 supports or more then, against 10 where
/// bodies meet by their rims.
[[nodiscard]] bool all_facets_pay(const PolytopeDifference& difference);

/// The nearest facet of P; `certified` false where anything is in doubt, or the bodies are apart. Requires
/// `all_facets_apply`, and of the difference `prepare_supports` and a reach between 2^-100 and 2^100. No allocation.
/// Time O(V F + K^2) for V vertices, F facets and K edges that may belong to a facet of P as near as the nearest of
/// either body.
[[nodiscard]] NearFacets nearest_of_all_facets(const Pose& pose_a, const Pose& pose_b,
                                               const PolytopeDifference& difference, const BracketWidth& width);

}  // namespace pd::detail
