/// @file
/// Polygons of the plane on which [D] section 4 is measured: stars, combs, spirals and plates with holes.
///
/// As shape_families.hpp: functions of their parameters and a seed, the same bits everywhere.
#pragma once

#include "pd/planar/polygon.hpp"
#include "scenes/shape_families.hpp"

namespace pd::scenes {

/// n corners round the origin, by turns near radius 1 and near 1/2, each moved a little. n >= 6, even.
[[nodiscard]] Polygon star_polygon(int n, Random& random);
/// n / 4 teeth of width 1 and height 10, a gap of 1 between them, on a back of height 1. n >= 8, divisible by 4.
[[nodiscard]] Polygon comb_polygon(int n);
/// A strip of width 1/2 wound round the origin, 1 between its turns, 64 corners a turn on either side. n >= 16, even.
[[nodiscard]] Polygon spiral_polygon(int n);
/// A square plate with k x k square holes of side 1, walls of 1 between them: 4 + 4 k^2 vertices.
[[nodiscard]] Polygon plate_with_holes(int k);
/// n points on an ellipse with half axes `radius` and 0.7 `radius`, convex. n >= 3.
[[nodiscard]] Polygon round_polygon(int n, double radius);

}  // namespace pd::scenes
