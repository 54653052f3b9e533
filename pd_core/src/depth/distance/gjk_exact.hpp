/// @file
/// The point of P nearest to the origin, in exact arithmetic: decides "apart or not" when doubles cannot, and gives the
/// distance as the root of a rational. The search (closest_search.hpp) begins in double-double, whose steps cost a
/// tenth of an exact one.
#pragma once

#include <array>
#include <cstdint>
#include <span>

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
[[nodiscard, gnu::cold]] ExactClosestPoint exact_closest_point(const PosedPair& pair, const VertexPair* start,
                                                               int count);

struct ClosestSimplex {
  std::array<VertexPair, 4> vertices;
  int count;
};

/// Vertices of P whose hull holds P's closest point to the origin, as far as double-double tells; nothing is proved.
[[nodiscard]] ClosestSimplex closest_simplex(const PosedPair& pair, std::span<const VertexPair> start);

}  // namespace pd::detail
