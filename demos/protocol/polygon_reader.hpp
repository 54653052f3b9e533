/// @file
/// Polygons and plane vectors out of a parsed line.
#pragma once

#include <vector>

#include "pd/planar/polygon.hpp"
#include "protocol/field_reader.hpp"
#include "protocol/limits.hpp"

namespace pd::query {

/// {"outer":[[x,y],...],"holes"?:[...]}; a refusal names the edge at fault ("p.holes[0][2]").
[[nodiscard]] Polygon read_polygon(const Node& node, const Limits& limits);
[[nodiscard]] Point2 read_point2(const Node& node);
/// As read_point2; zero_direction for [0,0].
[[nodiscard]] Point2 read_direction2(const Node& node);
/// A list of at most --max-vertices points or directions.
[[nodiscard]] std::vector<Point2> read_points2(const Node& node, const Limits& limits, bool directions);

}  // namespace pd::query
