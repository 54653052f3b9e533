/// @file
/// The point of P nearest to the origin in doubles, with a certified bracket of the distance.
///
/// The search is that of closest_search.hpp. The upper bound is the length of a convex combination of points of P, the
/// lower bound the height of a supporting plane: <s, v> / |v| for the support s against v. Where rounding stops
/// progress before the bracket is as narrow as asked, exact arithmetic takes over, or double-double
/// (gjk_double_double.hpp).
#pragma once

#include <span>

#include "depth/difference/bracket_width.hpp"
#include "depth/difference/polytope_difference.hpp"
#include "depth/difference/smooth_difference.hpp"

namespace pd::detail {

struct ClosestPoint {
  bool certified = false;  ///< the bracket is as narrow as asked and lower > 0
  double lower = 0;
  double upper = 0;
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::UnitX();  ///< unit; certified: the plane of `lower`, every point of P has <x, normal> <= -lower
  int count = 0;
  DifferenceVertex simplex[4];
  double weights[4];
};

/// What rounding may make of a bracket's ends.
struct DistanceErrors {
  double upper;  ///< of the length of a point of P
  double lower;  ///< of the height of a certified support
};
template <class Difference>
DistanceErrors distance_errors(const Difference& difference) {
  const double rounding = 8 * kUnitRoundoff * difference.reach();
  const double upper = difference.point_error() + rounding;
  return {upper, upper + difference.support_error()};
}

/// A nearest point that lies behind its plane by less, in units of the reach: nothing but rounding lies between them.
inline constexpr double kSearchGap = 4 * kUnitRoundoff;

/// If P seems to hold the origin, the point is the nearest one of the last triangle or edge, not certified.
///
/// @param start     one to four vertices of P to begin with; of four, the last is the nearest to a separating plane.
/// @param relative  stop when upper <= (1 + relative) lower, both less `width.margin` ...
/// @param width     ... or upper - lower is within it, by the largest |coordinate| seen.
/// Requires a reach between 2^-100 and 2^100.
template <class Difference>
ClosestPoint closest_point(const Difference& difference, std::span<const DifferenceVertex> start, double relative,
                           const BracketWidth& width, std::vector<std::int32_t>& stack, std::int64_t& support_calls);

extern template ClosestPoint closest_point(const SmoothDifference&, std::span<const DifferenceVertex>, double,
                                           const BracketWidth&, std::vector<std::int32_t>&, std::int64_t&);
extern template ClosestPoint closest_point(const PolytopeDifference&, std::span<const DifferenceVertex>, double,
                                           const BracketWidth&, std::vector<std::int32_t>&, std::int64_t&);

}  // namespace pd::detail
