/// @file
/// Large point sets at the speed of memory: extreme points first, then the points that may matter beside them.
///
/// Most points of a solid cloud lie strictly inside the hull of a few extreme ones. They are found in two passes over
/// the caller's array, in blocks of plain loops that compilers turn into vector code.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pd/numeric/vector.hpp"
#include "shape/hull/quickhull.hpp"

namespace pd::detail {

/// The points that are extreme along both ends of 13 lines: the axes, the diagonals of the sides of a cube and those of
/// the cube; ascending, distinct. Of points that are equally far out the one with the lowest index is taken. Requires a
/// point, and finite numbers.
[[nodiscard]] std::vector<std::int32_t> extreme_points(std::span<const Vec3> points);

/// The points that are not strictly inside the hull, ascending: all that it may still grow by are among them.
/// @param scale  brings the caller's numbers to the scale of the hull.
[[nodiscard]] std::vector<std::int32_t> points_not_inside(std::span<const Vec3> points, double scale,
                                                          const std::vector<HullTriangle>& hull);

}  // namespace pd::detail
