/// @file
/// A tetrahedron as a closed surface, and four of many points that span a large one: where every expansion begins.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "pd/numeric/vector.hpp"

namespace pd::detail {

/// Faces on vertices 0..3, counter-clockwise from outside where vertex 3 lies behind face 0 1 2.
inline constexpr std::int32_t kTetrahedronFaces[4][3] = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};

/// Across edge e of face f, which runs from its vertex e to the next.
struct TetrahedronSide {
  std::int32_t face;
  std::int32_t edge;
};
inline constexpr TetrahedronSide kTetrahedronBeyond[4][3] = {
    {{1, 2}, {2, 2}, {3, 2}}, {{3, 1}, {2, 0}, {0, 0}}, {{1, 1}, {3, 0}, {0, 1}}, {{2, 1}, {1, 0}, {0, 2}}};

/// Four points of many.
struct SpreadPoints {
  std::array<std::int32_t, 4> ids{};
  double six_volumes = 0;  ///< of their tetrahedron, not negative, rounded
};

/// Point 0, the farthest from it, the farthest from their line, and the farthest from their plane; of several the
/// first. Time O(count).
/// @param at  at(i) is point i, a Vec3.
template <class At>
SpreadPoints spread_points(std::int32_t count, At&& at) {
  SpreadPoints out;
  if (count < 4) return out;
  const auto farthest = [&](auto&& measure) {
    std::int32_t best = 0;
    double most = 0;
    for (std::int32_t i = 1; i < count; ++i) {
      const double value = measure(at(i));
      if (value > most) {
        most = value;
        best = i;
      }
    }
    return best;
  };
  const Vec3 from = at(0);
  out.ids[1] = farthest([&](const Vec3& x) { return (x - from).squaredNorm(); });
  const Vec3 along = at(out.ids[1]) - from;
  out.ids[2] = farthest([&](const Vec3& x) { return (x - from).cross(along).squaredNorm(); });
  const Vec3 normal = along.cross(at(out.ids[2]) - from);
  out.ids[3] = farthest([&](const Vec3& x) { return std::abs((x - from).dot(normal)); });
  out.six_volumes = std::abs((at(out.ids[3]) - from).dot(normal));
  return out;
}

}  // namespace pd::detail
