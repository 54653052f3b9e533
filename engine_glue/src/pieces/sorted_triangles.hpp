/// @file
/// The triangles around a body sorted along their longest way, to find those near a contact among many.
#pragma once

#include <LinearMath/btVector3.h>

#include <algorithm>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "shapes/triangles_around.hpp"

namespace pd::detail {

/// Keeps its memory.
class SortedTriangles {
 public:
  /// Requires a triangle. They are to stay where they are. Time O(k log k).
  void make(std::span<const MeshTriangle> triangles) {
    triangles_ = triangles;
    btVector3 lower = triangles[0].lower, upper = triangles[0].upper;
    for (const MeshTriangle& triangle : triangles) {
      lower.setMin(triangle.lower);
      upper.setMax(triangle.upper);
    }
    axis_ = (upper - lower).maxAxis();
    widest_ = 0;
    begins_.clear();
    for (std::size_t i = 0; i < triangles.size(); ++i) {
      const btScalar begin = triangles[i].lower[axis_];
      widest_ = std::max(widest_, triangles[i].upper[axis_] - begin);
      begins_.emplace_back(begin, i);
    }
    std::sort(begins_.begin(), begins_.end());
  }

  /// Calls `visit(i)` for each triangle whose box meets this one. Time O(sqrt k) for triangles of about one size on a
  /// surface, and no more than O(k).
  template <class Visit>
  void each_meeting(const btVector3& lower, const btVector3& upper, const Visit& visit) const {
    // Differences of floats are rounded.
    const std::pair<btScalar, std::size_t> first(lower[axis_] - btScalar(1.001) * widest_, 0);
    for (auto at = std::lower_bound(begins_.begin(), begins_.end(), first);
         at != begins_.end() && at->first <= upper[axis_]; ++at) {
      const MeshTriangle& triangle = triangles_[at->second];
      if (boxes_meet(triangle.lower, triangle.upper, lower, upper)) visit(at->second);
    }
  }

 private:
  std::span<const MeshTriangle> triangles_;
  int axis_ = 0;
  btScalar widest_ = 0;                                   ///< along that axis
  std::vector<std::pair<btScalar, std::size_t>> begins_;  ///< of boxes along that axis, and their triangles
};

}  // namespace pd::detail
