/// @file
/// A node of the hierarchy of boxes over a mesh's triangles.
#pragma once

#include <cstdint>

#include "pd/numeric/vector.hpp"

namespace pd {

/// Holds the triangles [first, last) in the order of the tree.
struct TriangleNode {
  Vec3 low, high;
  std::int32_t first = 0;
  std::int32_t last = 0;
  std::int32_t left = 0;  ///< 0: a leaf
  std::int32_t right = 0;

  [[nodiscard]] bool is_leaf() const { return right == 0; }
};

}  // namespace pd
