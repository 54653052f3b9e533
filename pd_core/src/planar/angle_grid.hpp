/// @file
/// Directions at equal steps round a square, in the order of a convex polygon's edges: a table over them says at once
/// between which edges a direction comes.
///
/// Direction k of `count` (a power of two, at least 4) goes from (0, -1) counter-clockwise along the square |x| + |y|
/// = 1; its coordinates are exact. Directions half the count apart are exactly opposite.
#pragma once

#include <cmath>
#include <cstdint>

#include "pd/planar/convex_polygon.hpp"

namespace pd::detail {

/// Requires 0 <= k < count <= 2^50.
inline Point2 grid_direction(std::int64_t k, std::int64_t count) {
  const std::int64_t quarter = count / 4;
  const double f = static_cast<double>(k % quarter) / static_cast<double>(quarter);
  switch (k / quarter) {
    case 0:
      return {f, f - 1};
    case 1:
      return {1 - f, f};
    case 2:
      return {-f, 1 - f};
    default:
      return {f - 1, -f};
  }
}

/// The place of a direction between those of the grid, in [0, count], within 2^-50 count. (0, -1) is at its end; what
/// is no direction is at 0.
inline double grid_place(const Point2& d, std::int64_t count) {
  const double size = std::abs(d[0]) + std::abs(d[1]);
  double quarters = 0;
  if (d[0] > 0) {
    quarters = d[1] < 0 ? d[0] / size : 1 + d[1] / size;
  } else {
    quarters = d[1] > 0 ? 2 - d[0] / size : 3 - d[1] / size;
  }
  return quarters >= 0 ? quarters * 0.25 * static_cast<double>(count) : 0;
}

}  // namespace pd::detail
