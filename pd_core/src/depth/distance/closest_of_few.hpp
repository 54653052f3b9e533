/// @file
/// The point of P nearest to the origin with a certified bracket, for bodies of few vertices: a search in lanes
/// (nearest_of_few.hpp) and the bounds of gjk.hpp on what it ends with.
#pragma once

#include <optional>
#include <span>

#include "depth/distance/gjk.hpp"
#include "depth/distance/nearest_of_few.hpp"

namespace pd::detail {

/// The bodies of a difference that does not climb and has `prepare_supports` called.
FewVertices posed_few(const PolytopeDifference& difference);

/// @param start     vertices of P to begin with, one to four.
/// @param relative  as for `closest_point`, and `width`.
/// Requires that the difference does not climb, has `prepare_supports` called, and a reach between 2^-100 and 2^100.
/// `certified` is false where the origin may lie in P or rounding left the bracket wider than asked.
ClosestPoint closest_of_few(const PolytopeDifference& difference, std::span<const DifferenceVertex> start,
                            double relative, const BracketWidth& width, std::int64_t& support_calls);

struct PlaneOfFew {
  Vec3 normal;         ///< unit
  double lower;        ///< certified: every point of P has <x, normal> <= -lower
  DifferenceVertex s;  ///< the point of P next to it
};
/// A plane farther from the origin than `least`, if a search from that vertex of P finds one. Requires the same.
std::optional<PlaneOfFew> plane_of_few(const PolytopeDifference& difference, const DifferenceVertex& first,
                                       double least, std::int64_t& support_calls);

/// The same of one to three vertices of P alone, certified where one support shows P no nearer: by a scan of few
/// vertices, by the simplex' neighbours of many. The bodies need not be turned for it.
ClosestPoint confirm_closest_point(const PolytopeDifference& difference, std::span<const VertexPair> simplex,
                                   double relative, const BracketWidth& width);

}  // namespace pd::detail
