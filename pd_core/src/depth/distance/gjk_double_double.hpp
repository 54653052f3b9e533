/// @file
/// The point of P nearest to the origin where plain doubles stop short: Gilbert, Johnson, Keerthi 1988 with
/// the simplices solved in double-double and the best bounds of all steps kept.
///
/// Close to contact the nearest points of successive simplices differ by less than a double tells, while their
/// directions are still to turn by 1e-6: |v|^2 falls by (angle)^2 |v|^2 alone, and a sliver of supports 1e-7 apart
/// loses its nearest point. In double-double the supports, whatever the rounding of their formula, count as exact
/// points: each step that is not the last comes strictly nearer, so it ends. The bounds allow for the formula's errors.
#pragma once

#include "depth/difference/smooth_difference.hpp"
#include "depth/distance/gjk.hpp"

namespace pd::detail {

struct ClosestPointWithNormal {
  ClosestPoint nearest;  ///< `point`, `simplex`, `weights` of `upper`
  Vec3 normal;           ///< unit; the plane of `lower`: every point of P has <x, normal> <= -lower
};

/// @param first     a vertex of P to begin with.
/// @param relative  stop when upper <= (1 + relative) lower, both less `width.margin` ...
/// @param width     ... or upper - lower is within it, by the largest |coordinate| seen.
/// `certified` is false where P holds the origin within rounding, or rounding left the bracket wider than asked.
/// Ends: each step but the last is strictly nearer, and there are at most `max_steps`.
template <class Difference>
ClosestPointWithNormal closest_point_double_double(const Difference& difference, const DifferenceVertex& first,
                                                   double relative, const BracketWidth& width, int max_steps,
                                                   std::vector<std::int32_t>& stack, std::int64_t& support_calls);

extern template ClosestPointWithNormal closest_point_double_double(const SmoothDifference&, const DifferenceVertex&,
                                                                   double, const BracketWidth&, int,
                                                                   std::vector<std::int32_t>&, std::int64_t&);
extern template ClosestPointWithNormal closest_point_double_double(const PolytopeDifference&, const DifferenceVertex&,
                                                                   double, const BracketWidth&, int,
                                                                   std::vector<std::int32_t>&, std::int64_t&);

}  // namespace pd::detail
