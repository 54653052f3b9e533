/// @file
/// The vertex of a polytope farthest in a direction of its own frame.
#pragma once

#include <cstdint>
#include <vector>

#include "pd/shape/convex_polytope.hpp"

namespace pd::detail {

/// Up to this many vertices a scan beats climbing.
inline constexpr int kScanLimit = 48;

/// A vertex that maximises <v, direction> up to rounding; on equal values of a scan the lowest id. `near` is where a
/// climb starts (-1: the best of a sample).
///
/// Scan up to kScanLimit vertices; above, hill climbing on the edge graph, which ends because the value strictly grows:
/// O(sqrt n) steps on round bodies, O(n) at worst.
int support_vertex(const ConvexPolytope& polytope, const Vec3& direction, int near);

/// As `support_vertex`, started at a vertex where climbing stopped, but the value is within rounding of the maximum for
/// certain: |<v, direction> - max| <= 6u |v| |direction|. `stack` is a buffer.
int certified_support_vertex(const ConvexPolytope& polytope, const Vec3& direction, int v,
                             std::vector<std::int32_t>& stack);

}  // namespace pd::detail
