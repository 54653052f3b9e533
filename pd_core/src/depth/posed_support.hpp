/// @file
/// Exact supports of P = B + (-A) by hill climbing, for directions known by the exact sign of <edge, direction>.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "depth/exact_nearest.hpp"
#include "shape/polytope_support.hpp"
#include "shape/posed_pair.hpp"

namespace pd::detail {

/// Climbs from `at` along edges whose `sign(from, to)` is positive. An exact local maximum over a convex body is the
/// maximum.
template <class Sign>
int climb_exactly(const ConvexPolytope& body, int at, Sign&& sign) {
  for (bool improved = true; improved;) {
    improved = false;
    for (const std::int32_t next : body.neighbours(at)) {
      if (sign(at, next) > 0) {
        at = next;
        improved = true;
        break;
      }
    }
  }
  return at;
}

/// The lowest vertex of the face on which `at` lies and along whose edges the sign is 0.
template <class Sign>
int lowest_of_face(const ConvexPolytope& body, int at, Sign&& sign, std::vector<std::int32_t>& stack) {
  int lowest = at;
  stack.assign(1, at);
  for (std::size_t i = 0; i < stack.size(); ++i) {
    const std::int32_t from = stack[i];
    for (const std::int32_t next : body.neighbours(from)) {
      if (std::find(stack.begin(), stack.end(), next) != stack.end() || sign(from, next) != 0) continue;
      stack.push_back(next);
      lowest = std::min(lowest, static_cast<int>(next));
    }
  }
  return lowest;
}

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
