/// @file
/// Depth of unions of any convex parts within (1 + delta): best-first octree over translations.
#pragma once

#include "compound/part_pairs.hpp"

namespace pd::detail {

/// As `penetration_depth` of compounds, for any parts.
[[nodiscard]] Expected<UnionDepth> solve_by_octree(const UnionPair& pair, Scratch& scratch,
                                                   const UnionSettings& settings);

}  // namespace pd::detail
