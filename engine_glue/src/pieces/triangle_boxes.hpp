/// @file
/// Boxes round groups of triangles, to find those near a contact among the many around a body.
#pragma once

#include <LinearMath/btVector3.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "shapes/triangles_around.hpp"

namespace pd::detail {

/// Groups of eight triangles, in the order of their places along a curve that fills space, groups of eight groups, and
/// so on. Keeps its memory.
class TriangleBoxes {
 public:
  /// Time O(k log k). The triangles are not needed any more.
  void make(std::span<const MeshTriangle> triangles);

  /// Calls `visit(i)` for each triangle whose box meets this one. Time O(m log k) for m of them, where triangles are of
  /// about one size.
  template <class Visit>
  void each_meeting(const btVector3& lower, const btVector3& upper, const Visit& visit) const {
    if (num_levels_ == 0) return;
    look(num_levels_ - 1, 0, levels_[num_levels_ - 1].size(), lower, upper, visit);
  }

 private:
  static constexpr std::size_t kGroup = 8;
  struct Box {
    btVector3 lower;
    btVector3 upper;
  };

  template <class Visit>
  void look(std::size_t level, std::size_t begin, std::size_t end, const btVector3& lower, const btVector3& upper,
            const Visit& visit) const {
    const std::vector<Box>& boxes = levels_[level];
    for (std::size_t i = begin; i < end; ++i) {
      if (!boxes_meet(boxes[i].lower, boxes[i].upper, lower, upper)) continue;
      if (level == 0) {
        visit(order_[i]);
      } else {
        look(level - 1, i * kGroup, std::min((i + 1) * kGroup, levels_[level - 1].size()), lower, upper, visit);
      }
    }
  }

  std::vector<std::vector<Box>> levels_;  ///< of the triangles, of groups of them, ...
  std::size_t num_levels_ = 0;            ///< of these, that are in use
  std::vector<std::size_t> order_;        ///< of the triangles on level 0
  std::vector<std::pair<std::uint64_t, std::size_t>> keys_;
};

}  // namespace pd::detail
