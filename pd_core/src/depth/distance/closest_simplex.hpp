/// @file
/// Where an exact search for the closest point begins: Gilbert, Johnson, Keerthi 1988 in double-double, ended where
/// that tells no more. A step costs a tenth of an exact one.
#pragma once

#include <array>
#include <span>

#include "shape/posed_pair.hpp"
#include "shape/support/vertex_pair.hpp"

namespace pd::detail {

struct ClosestSimplex {
  std::array<VertexPair, 4> vertices;
  int count;
};

/// Vertices of P whose hull holds P's closest point to the origin, nothing of it proved.
/// @param start  vertices of P to begin with, one to four.
[[nodiscard]] ClosestSimplex closest_simplex(const PosedPair& pair, std::span<const VertexPair> start);

}  // namespace pd::detail
