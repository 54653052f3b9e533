/// @file
/// Queries about the Minkowski difference P = B + (-A): support_of_difference, point_in_difference, directional_depth,
/// minkowski_difference.
#include "pd/depth/difference_queries.hpp"

#include <cmath>

#include "pd/depth/directional_depth.hpp"
#include "pd/depth/minkowski_difference.hpp"
#include "protocol/pair_reader.hpp"
#include "protocol/union_queries.hpp"

namespace pd::query {

namespace {

void write_vertices(const std::vector<std::int32_t>& vertices, const NamedShape& shape, JsonWriter& answer) {
  answer.begin_array();
  for (const std::int32_t vertex : vertices) {
    if (vertex >= 0) {
      answer.integer(shape.caller_id(vertex));
    } else {
      answer.null();  // the extreme point of a smooth body is no vertex
    }
  }
  answer.end_array();
}

DirectionalMethod read_directional_method(const Node& node) {
  const std::string word = read_string(node);
  if (word == "portal") return DirectionalMethod::portal;
  if (word == "overlay") return DirectionalMethod::overlay;
  if (word == "hierarchy") return DirectionalMethod::hierarchy;
  node.refuse("bad_value", "unknown method; known: hierarchy, portal, overlay");
}

}  // namespace

void answer_support_of_difference(const Node& line, Session& session, JsonWriter& answer) {
  allow_only(line, {"id", "query", "a", "pose_a", "b", "pose_b", "directions"});
  const Pair pair = read_pair(line, session.limits);
  const Node directions_node = line.at("directions");
  const std::vector<Vec3> directions = read_points(directions_node, session.limits.max_vertices);
  std::vector<double> values;
  std::vector<std::int32_t> on_a;
  std::vector<std::int32_t> on_b;
  for (std::size_t i = 0; i < directions.size(); ++i) {
    const Expected<DifferenceSupport> support = support_of_difference(pair.posed_a(), pair.posed_b(), directions[i]);
    if (!support) directions_node.element(i).refuse(to_string(support.error().code), support.error().message);
    if (!std::isfinite(support->value)) {
      directions_node.element(i).refuse("out_of_range",
                                        "the support is past the double range; give a shorter direction");
    }
    values.push_back(support->value);
    on_a.push_back(support->vertex_a);
    on_b.push_back(support->vertex_b);
  }
  answer.key("values").begin_array();
  for (const double value : values) answer.number(value);
  answer.end_array();
  answer.key("vertices_a");
  write_vertices(on_a, pair.a, answer);
  answer.key("vertices_b");
  write_vertices(on_b, pair.b, answer);
}

void answer_point_in_difference(const Node& line, Session& session, JsonWriter& answer) {
  allow_only(line, {"id", "query", "a", "pose_a", "b", "pose_b", "points"});
  const Pair pair = read_pair(line, session.limits);
  const Node points_node = line.at("points");
  const std::vector<Vec3> points = read_points(points_node, session.limits.max_vertices);
  std::vector<std::string_view> classes;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Expected<ContactClass> where =
        point_in_difference(pair.posed_a(), pair.posed_b(), points[i], session.scratch);
    if (!where) points_node.element(i).refuse(to_string(where.error().code), where.error().message);
    classes.push_back(to_string(*where));
  }
  answer.key("classes").begin_array();
  for (const std::string_view word : classes) answer.string(word);
  answer.end_array();
}

void answer_directional_depth(const Node& line, Session& session, JsonWriter& answer) {
  allow_only(line, {"id", "query", "a", "pose_a", "b", "pose_b", "direction", "method"});
  DirectionalMethod method = DirectionalMethod::portal;
  if (const auto node = line.find("method")) method = read_directional_method(*node);
  const Pair pair = read_pair(line, session.limits);
  const Node direction_node = line.at("direction");
  const Vec3 direction = read_vector(direction_node);
  if (method != DirectionalMethod::portal) {
    (void)require_polytope(pair.a, line.at("a"));
    (void)require_polytope(pair.b, line.at("b"));
  }
  const Stopwatch watch;
  const Expected<DirectionalDepth> result =
      directional_depth(pair.posed_a(), pair.posed_b(), direction, session.scratch, method);
  if (!result && result.error().where.empty()) line.refuse(to_string(result.error().code), result.error().message);
  if (!result) direction_node.refuse(to_string(result.error().code), result.error().message);
  write_directional_answer(*result, watch.nanoseconds(), answer);
}

void write_directional_answer(const DirectionalDepth& result, std::int64_t nanoseconds, JsonWriter& answer) {
  answer.key("depth").number(result.depth);
  answer.key("lower").number(result.lower);
  answer.key("upper").number(result.upper);
  answer.key("class").string(to_string(result.contact));
  write_statistics(result.statistics, nanoseconds, answer);
}

void answer_minkowski_difference(const Node& line, Session& session, JsonWriter& answer) {
  // Two convex bodies are answered within any budget: "max_work" is read, so that one form of line serves all bodies.
  allow_only(line, {"id", "query", "a", "pose_a", "b", "pose_b", "max_work"});
  (void)read_max_work(line);
  const Pair pair = read_pair(line, session.limits);
  const ConvexPolytope& a = require_polytope(pair.a, line.at("a"));
  const ConvexPolytope& b = require_polytope(pair.b, line.at("b"));
  const Expected<MinkowskiDifference> result =
      minkowski_difference(a, pair.pose_a, b, pair.pose_b, session.limits.max_vertices);
  if (!result) line.refuse(to_string(result.error().code), result.error().message + " (--max-vertices)");
  answer.key("vertices").begin_array();
  for (const MinkowskiDifference::Vertex& vertex : result->vertices) answer.vector(vertex.position);
  answer.end_array();
  answer.key("facets").begin_array();
  for (const MinkowskiDifference::Facet& facet : result->facets) {
    answer.begin_array();
    for (std::int32_t k = 0; k < facet.count; ++k) {
      answer.integer(result->corners[static_cast<std::size_t>(facet.first + k)]);
    }
    answer.end_array();
  }
  answer.end_array();
  answer.key("K").integer(result->num_facets());
  answer.key("facet_kinds").begin_array();
  for (const MinkowskiDifference::Facet& facet : result->facets) answer.string(to_string(facet.kind));
  answer.end_array();
}

}  // namespace pd::query
