/// @file
/// Exact supports of P = B + (-A) by hill climbing, for directions known by the exact sign of <edge, direction>.
#pragma once

#include "depth/exact_nearest.hpp"
#include "shape/polytope_support.hpp"
#include "shape/posed_pair.hpp"
#include "structure/exact_climb.hpp"

namespace pd::detail {

/// A vertex of P that is exactly extreme: of B along the direction, of A against it.
/// @param approximate  the direction in doubles (common frame), where the climb begins.
/// @param sign         exact sign of <edge, direction> for an edge of A or of B in the common frame.
template <class Sign>
PairId support_exactly(const PosedPair& pair, const Vec3& approximate, Sign&& sign) {
  const Vec3 on_a = -(pair.pose_a().rotation().transpose() * approximate);
  const Vec3 on_b = pair.pose_b().rotation().transpose() * approximate;
  const int a = climb_exactly(pair.a(), support_vertex(pair.a(), on_a, -1),
                              [&](int from, int to) { return -sign(PairVector::edge_a(from, to)); });
  const int b = climb_exactly(pair.b(), support_vertex(pair.b(), on_b, -1),
                              [&](int from, int to) { return sign(PairVector::edge_b(from, to)); });
  return {a, b};
}

}  // namespace pd::detail
