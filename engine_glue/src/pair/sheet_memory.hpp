/// @file
/// What a pair with a mesh keeps of the sides that its body came from (sheet_sides.hpp), handed from step to step.
#pragma once

#include <LinearMath/btTransform.h>

#include <cstdint>
#include <vector>

#include "pd/numeric/vector.hpp"

namespace pd::detail {

/// The side of a triangle that a body came from.
struct KnownFront {
  std::uint64_t triangle;  ///< of the pair's pieces
  Vec3 front;              ///< unit, in the mesh's frame
  double level;            ///< of the triangle's plane along it
};

/// The memory that a pair keeps from step to step.
struct SheetMemory {
  struct LastPose {
    int child;
    btTransform pose;  ///< in the mesh's frame
  };
  std::vector<KnownFront> fronts;  ///< sorted by triangle
  std::vector<LastPose> poses;     ///< of all children
  double behind = 0;               ///< how far the body was to be led back
  [[nodiscard]] bool empty() const { return fronts.empty() && poses.empty(); }
};

}  // namespace pd::detail
