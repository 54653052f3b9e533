/// @file
/// The expanding polytope of a smooth P on an exact hull (exact_hull.hpp): for the few queries whose surface in doubles
/// loses its convexity. The same goals, bounds and outcomes as in expanding_polytope.hpp, whose steps it follows; step
/// 4 cannot happen.
#pragma once

#include "depth/difference/smooth_difference.hpp"
#include "depth/expansion/exact_hull.hpp"
#include "depth/expansion/expansion_goal.hpp"
#include "depth/expansion/search_report.hpp"

namespace pd::detail {

/// @param start  unit direction in which the depth is expected.
/// `undecided` where rounding leaves the bracket wider than asked (face >= 0), or P is flat (face -1).
///
/// Ends: each pass adds a point more than 4 errors outside the hull, so that far from all points before it, of which a
/// body of radius R has no more than (R / error)^3; `goal.max_steps` bounds the passes besides.
ExpansionResult expand_exact_hull(const SmoothDifference& difference, ExactHull& hull, const Vec3& start,
                                  const ExpansionGoal& goal, std::int64_t& support_calls,
                                  const SearchWatch& watch = {});

}  // namespace pd::detail
