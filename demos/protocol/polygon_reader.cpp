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

Polygon read_polygon(const Node& node, const Limits& limits) {
  require_object(node);
  allow_only(node, {"outer", "holes"});
  const std::vector<Point2> outer = read_ring(node.at("outer"), limits);
  std::vector<std::vector<Point2>> holes;
  std::size_t vertices = outer.size();
  if (const auto list = node.find("holes")) {
    require_array(*list, "an array of holes, each an array of points [x,y]");
    for (std::size_t h = 0; h < list->size(); ++h) {
      holes.push_back(read_ring(list->element(h), limits));
      vertices += holes.back().size();
    }
    if (vertices > static_cast<std::size_t>(limits.max_vertices)) {
      list->refuse("limit_exceeded", std::to_string(vertices) + " vertices; the limit is " +
                                         std::to_string(limits.max_vertices) + " (--max-vertices)");
    }
  }
  Expected<Polygon> polygon = Polygon::from_rings(outer, holes);
  if (!polygon) node.refuse(polygon.error());
  return std::move(polygon).value();
}

}  // namespace pd::query
