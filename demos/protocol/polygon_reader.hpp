/// @file
/// Polygons and plane vectors out of a parsed line.
#pragma once

#include <vector>

#include "pd/planar/polygon.hpp"
#include "protocol/line/field_reader.hpp"
#include "protocol/line/limits.hpp"

namespace pd::query {

/// Rings as they were given.
struct PolygonRings {
  std::vector<Point2> outer;
  std::vector<std::vector<Point2>> holes;
  double margin = 0;
};
/// {"outer":[[x,y],...],"holes"?:[...],"margin"?:r}, at most --max-vertices in all.
[[nodiscard]] PolygonRings read_polygon_rings(const Node& node, const Limits& limits);
/// Checked. A single point with a margin is a disc.
[[nodiscard]] Expected<Polygon> polygon_of(const PolygonRings& rings);
struct SweptPolygon {
  Polygon polygon;
  double margin;
};
/// Rings, checked; a refusal names the edge at fault ("p.holes[0][2]").
[[nodiscard]] SweptPolygon read_polygon(const Node& node, const Limits& limits);
[[nodiscard]] Point2 read_point2(const Node& node);
/// As read_point2; zero_direction for [0,0].
[[nodiscard]] Point2 read_direction2(const Node& node);
/// A list of at most --max-vertices points or directions.
[[nodiscard]] std::vector<Point2> read_points2(const Node& node, const Limits& limits, bool directions);

}  // namespace pd::query
