/// @file
/// A triangle of a mesh that a body may reach.
#pragma once

#include <LinearMath/btVector3.h>

#include <cstdint>

namespace pd::detail {

/// With an area, in the mesh's frame, by the numbers that Bullet has for it.
struct MetTriangle {
  btVector3 corners[3];
  int part;
  int index;
  int child;  ///< of the body, by its place among those that were asked
};

/// Of a body's thickness. Deeper in a sheet than this, its shortest way out is back to where most of it is, over edges
/// or not, and no longer the triangle's own side.
inline constexpr double kShallow = 0.25;

}  // namespace pd::detail
