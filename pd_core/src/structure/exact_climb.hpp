/// @file
/// Exact hill climbing on the vertices of a polytope, for a direction known by the exact sign of <v[to] - v[from], n>.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "pd/shape/convex_polytope.hpp"

namespace pd::detail {

/// Above this a face is walked to along edges; below, a scan of all vertices is faster.
inline constexpr int kScannedVertices = 96;

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

/// The vertices of the largest face on which `at` lies and along whose edges the sign is 0: `at` alone, an edge, or a
/// facet, whose loop is stored. Time: the degree of `at`, in signs, and the face. `face` is the answer.
template <class Sign>
void level_face(const ConvexPolytope& body, int at, Sign&& sign, std::vector<std::int32_t>& face) {
  face.assign(1, at);
  const auto neighbours = body.neighbours(at);
  int edges[2];
  for (std::size_t k = 0; k < neighbours.size() && face.size() < 3; ++k) {
    if (sign(at, neighbours[k]) != 0) continue;
    edges[face.size() - 1] = body.first_half_edge(at) + static_cast<int>(k);
    face.push_back(neighbours[k]);
  }
  if (face.size() < 3) return;
  // Two level edges bound a facet, which lies on the left of one of them.
  const auto holds = [&](const IndexList& loop, std::int32_t v) {
    return std::find(loop.begin(), loop.end(), v) != loop.end();
  };
  for (const int edge : edges) {
    const auto loop = body.facet_vertices(body.half_edge(edge).facet);
    if (!holds(loop, face[1]) || !holds(loop, face[2])) continue;
    face.assign(loop.begin(), loop.end());
    return;
  }
}

/// The lowest vertex of that face. `face` is a buffer.
template <class Sign>
int lowest_of_face(const ConvexPolytope& body, int at, Sign&& sign, std::vector<std::int32_t>& face) {
  level_face(body, at, sign, face);
  return *std::min_element(face.begin(), face.end());
}

}  // namespace pd::detail
