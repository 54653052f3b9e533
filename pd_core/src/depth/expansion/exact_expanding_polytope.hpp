/// @file
/// The expanding polytope with exact signs: the engine behind the doubles.
///
/// Keeps the exact convex hull of the vertices of P found so far. A face whose plane supports P exactly is a facet of
/// P; the least of those that no other face can undercut is the depth. Decides touching against overlapping, and ranks
/// facets whose distances agree to the last bits.
#pragma once

#include <optional>

#include "depth/distance/gjk_exact.hpp"
#include "depth/expansion/search_report.hpp"
#include "numeric/quotient.hpp"
#include "pd/depth/depth_answer.hpp"

namespace pd::detail {

struct ExactDepth {
  ContactClass contact = ContactClass::touching;
  bool complete = true;                  ///< false: the budget ran out before the nearest facet was certain
  std::optional<ExactDirection> normal;  ///< of the nearest facet of P (overlapping), or a supporting normal (touching)
  SquaredRatio squared;                  ///< overlapping only
  std::int64_t support_calls = 0;
  std::int64_t facets_visited = 0;
};

/// Requires that the origin lies in P (boundary included).
/// @param simplex  vertices of P to begin with.
/// @param budget   supports allowed.
[[nodiscard, gnu::cold]] ExactDepth exact_expanding_polytope(const PosedPair& pair, const VertexPair* simplex,
                                                             int count, int budget, const SearchWatch& watch = {});

}  // namespace pd::detail
