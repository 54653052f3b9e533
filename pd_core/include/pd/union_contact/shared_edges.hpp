/// @file
/// Triangles around a body that share an edge know what is on its other side without a search.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "pd/numeric/vector.hpp"

namespace pd {

/// Triangles share an edge if both of its ends are the same, bit for bit. A T-junction, or a seam that agrees only up
/// to rounding, is no shared edge and has to be searched. An object reuses its memory.
class SharedEdges {
 public:
  /// Looks at them when the first of their edges is asked for. They are to stay where they are.
  void begin(std::span<const std::array<Vec3, 3>> triangles) {
    triangles_ = triangles;
    known_ = false;
  }

  /// The corner, off the edge, of the triangle that shares the edge from corner `edge` to the next; null: none does.
  /// Of several the first. Time O(k) the first time, then O(1).
  [[nodiscard]] const Vec3* across(std::size_t triangle, std::size_t edge) {
    const std::int32_t other = twin(triangle, edge);
    if (other < 0) return nullptr;
    const auto at = static_cast<std::size_t>(other);
    return &triangles_[at / 3][(at % 3 + 2) % 3];
  }

  /// Calls `visit(corner)` for the other end of each edge that ends in a corner of the triangle, going round it from
  /// triangle to triangle, until one returns true or all were seen.
  /// @return whether all round it was seen, or a visit returned true
  template <class Visit>
  [[nodiscard]] bool round_corner(std::size_t triangle, std::size_t corner, const Visit& visit) {
    const Vec3& centre = triangles_[triangle][corner];
    std::size_t here = triangle, edge = corner;  // the edge over which the way leads out of a triangle
    for (int i = 0; i < kMostRound; ++i) {
      const std::int32_t other = twin(here, edge);
      if (other < 0) return false;
      const auto at = static_cast<std::size_t>(other);
      here = at / 3;
      edge = at % 3;
      const Vec3* const corners = triangles_[here].data();
      // The shared edge ends in the centre where corners run the same way, else it begins there.
      const bool ends = same(corners[(edge + 1) % 3], centre);
      if (visit(corners[ends ? edge : (edge + 1) % 3])) return true;
      if (here == triangle) return true;
      edge = ends ? (edge + 1) % 3 : (edge + 2) % 3;
    }
    return false;
  }

 private:
  /// More edges do not meet in a corner of an ordinary mesh.
  static constexpr int kMostRound = 64;
  static bool same(const Vec3& x, const Vec3& y) { return x == y; }
  /// Returns the same edge of another triangle, -1: there is none.
  std::int32_t twin(std::size_t triangle, std::size_t edge) {
    if (!known_) find();
    return twins_[3 * triangle + edge];
  }

  struct Edge {
    std::uint64_t both;  ///< of its ends
    const Vec3* begin;
    const Vec3* end;
    std::int32_t next;  ///< in the same place
  };
  void find();

  std::span<const std::array<Vec3, 3>> triangles_;
  bool known_ = false;
  std::vector<std::int32_t> twins_;  ///< of each edge of each triangle, -1: none
  std::vector<Edge> edges_;
  std::vector<std::int32_t> first_;  ///< of the edges that fall into one place
};

}  // namespace pd
