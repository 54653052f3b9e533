#include "protocol/polygon_reader.hpp"

#include <string>
#include <utility>

namespace pd::query {

namespace {

std::vector<Point2> read_ring(const Node& node, const Limits& limits) { return read_points2(node, limits, false); }

}  // namespace

Point2 read_point2(const Node& node) {
  const std::vector<double> numbers = read_numbers(node, 2);
  return {numbers[0], numbers[1]};
}

Point2 read_direction2(const Node& node) {
  const Point2 d = read_point2(node);
  if (d == Point2{0, 0}) node.refuse("zero_direction", "a direction must not be zero");
  return d;
}

std::vector<Point2> read_points2(const Node& node, const Limits& limits, bool directions) {
  require_array(node, directions ? "an array of directions [x,y]" : "an array of points [x,y]");
  if (node.size() > static_cast<std::size_t>(limits.max_vertices)) {
    node.refuse("limit_exceeded", std::to_string(node.size()) + " points; the limit is " +
                                      std::to_string(limits.max_vertices) + " (--max-vertices)");
  }
  std::vector<Point2> points;
  for (std::size_t i = 0; i < node.size(); ++i) {
    points.push_back(directions ? read_direction2(node.element(i)) : read_point2(node.element(i)));
  }
  return points;
}

PolygonRings read_polygon_rings(const Node& node, const Limits& limits) {
  require_object(node);
  allow_only(node, {"outer", "holes", "margin"});
  PolygonRings rings{read_ring(node.at("outer"), limits), {}, 0};
  std::size_t vertices = rings.outer.size();
  if (const auto list = node.find("holes")) {
    require_array(*list, "an array of holes, each an array of points [x,y]");
    for (std::size_t h = 0; h < list->size(); ++h) {
      rings.holes.push_back(read_ring(list->element(h), limits));
      vertices += rings.holes.back().size();
    }
    if (vertices > static_cast<std::size_t>(limits.max_vertices)) {
      list->refuse("limit_exceeded", std::to_string(vertices) + " vertices; the limit is " +
                                         std::to_string(limits.max_vertices) + " (--max-vertices)");
    }
  }
  if (const auto margin = node.find("margin")) {
    rings.margin = read_number(*margin);
    if (rings.margin < 0) margin->refuse("bad_value", "a margin must not be negative");
    if (rings.margin > 1e300) margin->refuse("out_of_range", "a margin must be at most 1e300");
  }
  return rings;
}

Expected<Polygon> polygon_of(const PolygonRings& rings) {
  if (rings.margin > 0 && rings.outer.size() == 1 && rings.holes.empty()) return Polygon::at_point(rings.outer.front());
  return Polygon::from_rings(rings.outer, rings.holes);
}

SweptPolygon read_polygon(const Node& node, const Limits& limits) {
  const PolygonRings rings = read_polygon_rings(node, limits);
  Expected<Polygon> polygon = polygon_of(rings);
  if (!polygon) node.refuse(polygon.error());
  return {std::move(polygon).value(), rings.margin};
}

}  // namespace pd::query
