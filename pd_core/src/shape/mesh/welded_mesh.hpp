/// @file
/// A mesh whose equal points are one vertex, and its edges with all faces that use them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "pd/shape/mesh_check.hpp"

namespace pd::detail {

/// Loops over the caller's points; a vertex is the lowest index of its duplicates.
struct WeldedMesh {
  std::span<const Vec3> points;
  std::int64_t distinct = 0;
  std::vector<std::int32_t> offsets{0};  ///< one more than the caller's faces
  std::vector<std::int32_t> corners;     ///< vertices; a loop does not name one twice in a row
  std::vector<std::int32_t> face_of;     ///< of each corner

  [[nodiscard]] std::int32_t num_faces() const { return static_cast<std::int32_t>(offsets.size()) - 1; }
  [[nodiscard]] std::span<const std::int32_t> face(std::int32_t f) const {
    const auto at = static_cast<std::size_t>(f);
    return {corners.data() + offsets[at], static_cast<std::size_t>(offsets[at + 1] - offsets[at])};
  }
  [[nodiscard]] std::int32_t vertex(std::int32_t corner) const { return corners[static_cast<std::size_t>(corner)]; }
  [[nodiscard]] const Vec3& point(std::int32_t corner) const {
    return points[static_cast<std::size_t>(vertex(corner))];
  }
  [[nodiscard]] std::int32_t next(std::int32_t corner) const {
    const auto f = static_cast<std::size_t>(face_of[static_cast<std::size_t>(corner)]);
    return corner + 1 == offsets[f + 1] ? offsets[f] : corner + 1;
  }
  [[nodiscard]] std::int32_t previous(std::int32_t corner) const {
    const auto f = static_cast<std::size_t>(face_of[static_cast<std::size_t>(corner)]);
    return corner == offsets[f] ? offsets[f + 1] - 1 : corner - 1;
  }
};

/// Faces of fewer than three different vertices become empty loops: their edges cancel each other.
[[nodiscard]] WeldedMesh weld(const MeshView& mesh);

/// Sorts sides of edges by their lower vertex, and those of one lower vertex by `less`. Most vertices have few edges,
/// so that buckets are quicker than sorting the whole.
template <class EdgeSide, class Less>
void sort_edges(std::vector<EdgeSide>& sides, const Less& less) {
  std::int32_t vertices = 0;
  for (const EdgeSide& side : sides) vertices = std::max(vertices, side.low + 1);
  std::vector<std::size_t> ends(static_cast<std::size_t>(vertices) + 1, 0);
  for (const EdgeSide& side : sides) ++ends[static_cast<std::size_t>(side.low) + 1];
  for (std::size_t v = 1; v < ends.size(); ++v) ends[v] += ends[v - 1];
  std::vector<EdgeSide> sorted(sides.size());
  for (const EdgeSide& side : sides) sorted[ends[static_cast<std::size_t>(side.low)]++] = side;
  std::size_t begin = 0;
  for (const std::size_t end : ends) {
    if (end > begin + 1) {
      std::sort(sorted.begin() + static_cast<std::ptrdiff_t>(begin), sorted.begin() + static_cast<std::ptrdiff_t>(end),
                less);
    }
    begin = std::max(begin, end);
  }
  sides = std::move(sorted);
}

/// A face's way along an edge: from the corner to the next one of its loop.
struct EdgeUse {
  std::int32_t low, high;  ///< the edge's vertices
  std::int32_t corner;
  [[nodiscard]] bool same_edge(const EdgeUse& other) const { return low == other.low && high == other.high; }
};
/// All of them, those of one edge side by side, in the order of their corners.
[[nodiscard]] std::vector<EdgeUse> sorted_edges(const WeldedMesh& mesh);

}  // namespace pd::detail
