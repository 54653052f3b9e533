/// @file
/// The point of P nearest to the origin, in exact arithmetic: decides "apart or not" when doubles cannot, and gives the
/// distance as the root of a rational.
///
/// Gilbert, Johnson, Keerthi, "A fast procedure for computing the distance between complex objects in three-dimensional
/// space", 1988, with every sign exact: the distance strictly falls at each step among finitely many simplices, so it
/// ends.
#pragma once

#include <array>
#include <cstdint>

#include "depth/difference/exact_support.hpp"
#include "shape/support/vertex_pair.hpp"

namespace pd::detail {

struct ExactClosestPoint {
  bool apart = false;  ///< the origin lies outside P
  int count = 0;       ///< size of the simplex whose relative interior holds the nearest point
  std::array<VertexPair, 4> simplex{};
  std::array<double, 4> weights{};  ///< barycentric coordinates of the nearest point, rounded
  Dyadic3 point;                    ///< nearest point times `scale` > 0 (apart only)
  Dyadic scale;
};

/// @param start  vertices of P to begin with (1 to 4), e.g. the simplex of an inexact search; not trusted.
[[nodiscard]] ExactClosestPoint exact_closest_point(const PosedPair& pair, const VertexPair* start, int count);

}  // namespace pd::detail
