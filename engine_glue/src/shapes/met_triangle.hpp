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

/// Of a child (-1: the body itself) and a triangle; unlike those of any other two, of up to 65,535 children and parts.
inline std::uint64_t number_of_pieces(int child, const MetTriangle& triangle) {
  return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(child + 1)) << 48U) ^
         (static_cast<std::uint64_t>(static_cast<std::uint32_t>(triangle.part)) << 32U) ^
         static_cast<std::uint32_t>(triangle.index);
}

}  // namespace pd::detail
