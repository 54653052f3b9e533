/// @file
/// Where a line enters a polytope, exactly, from the facet that a descent of its outer hierarchy ends with ([D] Lemma
/// 5.2).
///
/// Along the line facet f stands for slope t <= offset, so the line enters by the largest offset / slope among negative
/// slopes and leaves by the least among positive ones. That it misses is proved by two facets, or one that it does not
/// cross; that it enters by a facet, by the neighbours of this facet: none cuts the point of entry off.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>

#include "numeric/dyadic.hpp"
#include "pd/structure/polyhedral_hierarchy.hpp"

namespace pd::detail {

struct OuterCrossing {
  /// t at the point of entry as numerator / denominator, in multiples of the direction. Empty: the line does not meet
  /// the interior.
  std::optional<std::pair<Dyadic, Dyadic>> entry;
  std::int64_t steps = 0;        ///< facets evaluated by the descent
  std::int64_t certificate = 0;  ///< facets looked at in the exact check
  std::int32_t repairs = 0;      ///< scans of all facets, where rounding hid the way
};

/// Requires an outer hierarchy, finite numbers and a direction other than zero.
[[nodiscard]] OuterCrossing cross_outer_hierarchy(const PolyhedralHierarchy& outer, const Vec3& point,
                                                  const Vec3& direction);

}  // namespace pd::detail
