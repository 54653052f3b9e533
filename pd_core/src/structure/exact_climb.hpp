/// @file
/// Exact hill climbing on the vertices of a polytope, for a direction known by the exact sign of <v[to] - v[from], n>.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "pd/shape/convex_polytope.hpp"

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

/// The lowest vertex of the face on which `at` lies and along whose edges the sign is 0. `stack` is a buffer.
template <class Sign>
int lowest_of_face(const ConvexPolytope& body, int at, Sign&& sign, std::vector<std::int32_t>& stack) {
  int lowest = at;
  stack.assign(1, at);
  for (std::size_t i = 0; i < stack.size(); ++i) {
    const std::int32_t from = stack[i];
    for (const std::int32_t next : body.neighbours(from)) {
      if (sign(from, next) != 0 || std::find(stack.begin(), stack.end(), next) != stack.end()) continue;
      stack.push_back(next);
      lowest = std::min(lowest, static_cast<int>(next));
    }
  }
  return lowest;
}

}  // namespace pd::detail
