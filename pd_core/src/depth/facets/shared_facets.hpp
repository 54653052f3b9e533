/// @file
/// Facets of P that a facet of A and a facet of B make together: their outward normals are exactly opposite.
///
/// All pieces of an edge of the one and an edge of the other that the overlay cuts such a facet into lie in one plane,
/// which step 1 of [A] section 2 measures: the arcs of both edges begin at its normal, and two great circles that are
/// not one meet nowhere else but opposite to it, where an arc of less than half a circle does not come (a flat body's
/// arcs do, and meet no other there). Two aligned prisms of n sides have n^2 of them on either end, all as near as
/// their ends are.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "structure/overlay/overlay_walk.hpp"

namespace pd::detail {

/// By facet of A and of B: the number of the facet of P that it shares with one of the other body, or -1.
struct SharedFacets {
  std::vector<std::int32_t> of_a;
  std::vector<std::int32_t> of_b;
  std::vector<std::int32_t> large_a;  ///< facets of A that were tried
  std::int32_t count = 0;
};

/// The shared facets to both of which an edge belongs; -1: none.
using EdgeFacets = std::array<std::int32_t, 2>;

inline bool in_one_facet(const EdgeFacets& x, const EdgeFacets& y) {
  const auto among = [&](std::int32_t facet) { return facet >= 0 && (facet == y[0] || facet == y[1]); };
  return among(x[0]) || among(x[1]);
}

/// Finds those of two facets with many edges each, at least the root of their body's number: others hold few pairs.
/// Time O(F + E): no more than 4 E pairs of such facets are tried.
void find_shared_facets(const OverlayWalk& walk, SharedFacets& shared);

}  // namespace pd::detail
