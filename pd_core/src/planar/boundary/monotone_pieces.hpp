/// @file
/// A region bounded by rings, cut into triangles by a sweep that makes monotone pieces.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "pd/planar/polygon.hpp"

namespace pd::detail {

/// Triangles (counter-clockwise, but for some of no area where points are collinear) of the region on the left of all
/// `rings`, lists of indices into `points`. Requires rings that do not cross. If they touch, every corner must be
/// one of a single part of the region, as the boundary of a Polygon has them.
void triangulate_region(std::span<const Point2> points, std::span<const std::vector<std::int32_t>> rings,
                        std::vector<std::array<std::int32_t, 3>>& triangles);

}  // namespace pd::detail
