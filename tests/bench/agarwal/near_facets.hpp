/// @file
/// K_delta of [A] section 3.2 by brute force: the facets of P = B + (-A) that meet a ball about the origin, every facet
/// looked at.
#pragma once

#include <cstdint>
#include <span>

#include "scenes/agarwal_families.hpp"

namespace pd::bench {

/// Squared distance of the origin from a flat convex polygon, its corners in either order; rounded.
[[nodiscard]] double squared_distance_from_origin(std::span<const Vec3> corners);

/// Facets of P (pieces of one plane singly, as the shallow search counts them) at a distance of at most `radius` from
/// the origin: the facet's, not its plane's. In doubles: exact but for facets within 1e-12 of the radius, which count.
/// Time O(K).
[[nodiscard]] std::int64_t count_near_facets(const scenes::PolytopePair& pair, double radius);

}  // namespace pd::bench
