/// @file
/// Exact penetration depth at a cost that follows the number of facets near the origin: [A] section 3.2, algorithm
/// Shallow-Penetration, with its step 5(i) corrected.
///
/// Rays along a grid of directions bound the depth within (1 + delta / 4). From the facets that the shortest rays
/// hit, a breadth-first search visits the facets of P = B + (-A), which is never built, inside a ball that is little
/// larger than the depth.
///
/// Departure: step 5(i) starts from "the face of P supported by the plane orthogonal to u". On the slab [-L, L]^2 x
/// [-1, 1] that is a corner, at a distance of about 1.4 L and outside the ball, for every u that is not exactly
/// vertical. The search starts from the facet that the ray u hits. On the great arc from the nearest point's
/// direction v to u the boundary stays within pi / cos(angle), inside the ball. The two facets are therefore
/// connected in it, and Theorem 3.5 holds. (`tests/depth/shallow_test.cpp` keeps the slab.)
///
/// [A] Agarwal, Guibas, Har-Peled, Rabinovitch, Sharir, "Penetration depth of two convex polytopes in 3D", 2000.
#pragma once

#include "pd/depth/penetration_depth.hpp"
#include "pd/numeric/expected.hpp"

namespace pd {

class Scratch;

struct ShallowPenetration {
  PenetrationDepth answer;
  ShallowCounts counts;
};

/// Exact depth of two (rounded) polytopes, as `penetration_depth`, whatever delta: it sets the balance between rays and
/// facets.
///
/// Time O(m + n + (1 / delta) S + visited facets' degrees), S a portal search (measured O(log^2) exact signs). K_delta,
/// which bounds the visited facets, is the number of facets within (1 + delta) pi. A point or a segment has a P of O(m
/// + n) facets, which are all looked at.
///
/// @param delta  in (0, 1].
/// @param max_directions  rays allowed.
/// @return ErrorCode::bad_value ("delta"), unsupported (a smooth body), limit_exceeded ("delta").
[[nodiscard]] Expected<ShallowPenetration> shallow_penetration(const PosedShape& a, const PosedShape& b,
                                                               Scratch& scratch, double delta,
                                                               Bracket bracket = Bracket::tightest,
                                                               std::int64_t max_directions = std::int64_t{1} << 22);

}  // namespace pd
