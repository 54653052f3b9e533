/// @file
/// Best-first expansion of a smooth P on a surface kept by exact signs: for the few queries whose surface in doubles
/// folds (exact_hull.hpp). Same goals, same bounds, same outcomes as expansion.hpp; it ends, since each step finds a
/// point farther out than its own rounding.
#pragma once

#include "depth/difference/smooth_difference.hpp"
#include "depth/expansion/exact_hull.hpp"
#include "depth/expansion/expanding_polytope.hpp"

namespace pd::detail {

/// @param start  unit direction in which the depth is expected.
/// `undecided` where rounding leaves the bracket wider than asked (face >= 0), or P is flat (face -1).
ExpansionResult folded_expansion(const SmoothDifference& difference, ExactSurface& surface, const Vec3& start,
                                 const ExpansionGoal& goal, std::int64_t& support_calls);

}  // namespace pd::detail
