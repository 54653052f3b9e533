/// @file
/// A polygon in few convex parts: the triangles of a triangulation, joined over diagonals that neither end needs
/// (Hertel and Mehlhorn, "Fast triangulation of simple polygons", 1983: at most four times the least number).
#pragma once

#include <vector>

#include "planar/boundary/convex_sum.hpp"
#include "planar/boundary/triangulation.hpp"

namespace pd::detail {

/// The triangles inside as they are. Requires that the points stay where they are.
[[nodiscard]] std::vector<ConvexPart> triangles_inside(const Triangulation& triangulation,
                                                       const std::vector<Point2>& points);

/// The triangles inside, joined. Corners of a part may lie inside one of its sides. A flat triangle stays alone.
[[nodiscard]] std::vector<ConvexPart> convex_parts(const Triangulation& triangulation,
                                                   const std::vector<Point2>& points);

}  // namespace pd::detail
