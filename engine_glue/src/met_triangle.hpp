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
};

}  // namespace pd::detail
