/// @file
/// The point of P nearest to the origin with a certified bracket, for bodies of few vertices: a search in lanes
/// (nearest_of_few.hpp) and the bounds of gjk.hpp on what it ends with.
#pragma once

#include <limits>
#include <span>

#include "depth/distance/gjk.hpp"

namespace pd::detail {

struct ClosestOfFew {
  ClosestPoint nearest;
  bool beyond = false;  ///< stopped by a plane farther than asked: `nearest.normal` and `lower`, and `next_to_plane`
  DifferenceVertex next_to_plane{Vec3::Zero(), -1, -1};
};

struct FewSettings {
  double relative = 0;  ///< as for `closest_point`
  BracketWidth width;
  /// A plane farther than this is enough, and a point of P that is no farther shows that there is none.
  double beyond = std::numeric_limits<double>::infinity();
};

/// @param start  vertices of P to begin with, one to four.
/// Requires that the difference does not climb, has `prepare_supports` called, and a reach between 2^-100 and 2^100.
/// `certified` is false where the origin may lie in P or rounding left the bracket wider than asked.
ClosestOfFew closest_of_few(const PolytopeDifference& difference, std::span<const DifferenceVertex> start,
                            const FewSettings& settings, std::int64_t& support_calls);

/// The same of one to three vertices of P alone, certified where one support shows P no nearer: for bodies that need
/// not be turned for it.
ClosestPoint confirm_closest_of_few(const PolytopeDifference& difference, std::span<const VertexPair> simplex,
                                    double relative, const BracketWidth& width);

}  // namespace pd::detail
