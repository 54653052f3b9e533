/// @file
/// Neighbouring convex parts are merged into their common hull, where the hull is good enough.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "pd/shape/convex_polytope.hpp"

namespace pd::detail {

struct SolidPart {
  ConvexPolytope polytope;
  double error = 0;       ///< certified: the most that the part differs from the solid
  bool measured = false;  ///< the error is that of rounding, and cannot be told better
};

struct MergingRules {
  /// Pairs whose boxes are farther from each other are not tried.
  double gap = 0;
  /// The error of a hull, if the hull is good enough.
  std::function<std::optional<double>(const ConvexPolytope& hull)> error_of;
  /// False: the work ends.
  std::function<bool()> goes_on;
  /// Takes note of work: the points of a hull that was made.
  std::function<void(std::int64_t)> spend;
};

/// Merges the pair whose hull adds the smallest share of volume first, until no pair has a hull that is good enough. A
/// part that lies in another is left out.
[[nodiscard]] std::vector<SolidPart> merged(std::vector<SolidPart> parts, const MergingRules& rules);

/// Volume of a polytope of dimension 3, rounded.
[[nodiscard]] double volume_of(const ConvexPolytope& polytope);

}  // namespace pd::detail
