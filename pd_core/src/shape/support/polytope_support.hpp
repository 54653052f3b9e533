/// @file
/// The vertex of a polytope farthest in a direction of its own frame.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pd/shape/convex_polytope.hpp"

namespace pd::detail {

/// Up to this many vertices a scan in double precision beats everything else.
inline constexpr int kScanLimit = 48;

/// A vertex that maximises <v, direction> up to rounding; on equal values of a scan the lowest id. `near` is a vertex
/// that may be close to it, or -1.
///
/// Scan up to kScanLimit vertices; above, hill climbing in double from the better of `near` and what the table of
/// directions offers. The climb ends because the value strictly grows: a step or none on round bodies, O(n) at worst.
int support_vertex(const ConvexPolytope& polytope, const Vec3& direction, int near);

/// A vertex that is nearly as far as the farthest, or -1: of a large body the best of a few that one look into the
/// table of directions finds, whatever the size.
int coarse_support_vertex(const ConvexPolytope& polytope, const Vec3& direction);

/// As `support_vertex`, started at a vertex where climbing stopped, but the value is within rounding of the maximum for
/// certain: |<v, direction> - max| <= 6u |v| |direction|. `stack` is a buffer.
int certified_support_vertex(const ConvexPolytope& polytope, const Vec3& direction, int v,
                             std::vector<std::int32_t>& stack);

/// The best of three vertices (repetitions allowed) and of those level with them, if it is a maximiser as
/// `certified_support_vertex` returns it: every edge that leaves these descends for certain, so by convexity they hold
/// the maximum. Otherwise -1.
int confirmed_support_vertex(const ConvexPolytope& polytope, const Vec3& direction, const std::array<int, 3>& vertices);

}  // namespace pd::detail
