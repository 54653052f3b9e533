/// @file
/// polygon_depth: two polygons of the plane, Q moves ([D] section 4).
#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "pd/planar/polygon_depth.hpp"
#include "protocol/pair_reader.hpp"
#include "protocol/polygon_reader.hpp"

namespace pd::query {

namespace {

/// Explicit sums are one for every two triangles; a line may not ask for more.
constexpr std::int64_t kMostSums = 1 << 20;

PolygonMethod read_polygon_method(const Node& line) {
  const auto node = line.find("method");
  if (!node) return PolygonMethod::automatic;
  const std::string word = read_string(*node);
  if (word == "auto") return PolygonMethod::automatic;
  if (word == "implicit") return PolygonMethod::implicit;
  if (word == "explicit") return PolygonMethod::explicit_sums;
  node->refuse("bad_value", "unknown method; known: auto, implicit, explicit");
}

bool read_flag(const Node& line, std::string_view key) {
  const auto node = line.find(key);
  if (!node) return false;
  if (!node->json().is_boolean()) node->refuse("bad_value", "must be true or false");
  return node->json().get<bool>();
}

/// What a line asks of every placement.
struct Question {
  Leave leave = Leave::first_exit;
  std::vector<Point2> directions;  ///< empty: the least over all

  [[nodiscard]] PolygonDepth answer(const PolygonDifference& r, const Point2& y, std::size_t direction) const {
    if (!directions.empty()) return r.depth_along(y, directions[direction], leave);
    return leave == Leave::escape ? r.escape_depth(y) : r.depth(y);
  }
};

Leave read_leave(const Node& line) {
  const auto node = line.find("complete");
  if (!node) return Leave::first_exit;
  if (node->json().is_boolean()) return node->json().get<bool>() ? Leave::straight : Leave::first_exit;
  const std::string word = read_string(*node);
  if (word == "straight") return Leave::straight;
  if (word == "escape") return Leave::escape;
  node->refuse("bad_value", "must be true, false, \"straight\" or \"escape\"");
}

Question read_question(const Node& line) {
  Question question{read_leave(line), {}};
  const auto direction = line.find("direction");
  const auto set = line.find("direction_set");
  if (direction && set) set->refuse("bad_value", "give either \"direction\" or \"direction_set\"");
  if (direction) question.directions = {read_direction2(*direction)};
  if (set) {
    question.directions = read_points2(*set, {}, true);
    if (question.directions.empty()) set->refuse("bad_value", "needs a direction at least");
  }
  if (question.leave == Leave::straight && question.directions.empty()) {
    line.refuse("missing_field", "going straight needs a \"direction\" (or \"complete\":\"escape\" for any motion)");
  }
  return question;
}

void write_point(const Point2& x, JsonWriter& answer) { answer.begin_array().number(x[0]).number(x[1]).end_array(); }

void write_vertex(std::string_view key, const Polygon::VertexId& id, bool edge, JsonWriter& answer) {
  answer.key(key).begin_object().key("kind").string(edge ? "edge" : "vertex");
  answer.key("ring").string(id.ring < 0 ? "outer" : "holes[" + std::to_string(id.ring) + "]");
  answer.key("index").integer(id.index).end_object();
}

void write_feature(const std::optional<PlanarFeature>& feature, JsonWriter& answer) {
  if (!feature) {
    answer.null();
    return;
  }
  answer.begin_object();
  write_vertex("p", feature->p, feature->p_edge, answer);
  write_vertex("q", feature->q, feature->q_edge, answer);
  answer.end_object();
}

/// "depth" for one answer, "depths" for a list, for every field.
void write_answers(const std::vector<PolygonDepth>& answers, bool list, JsonWriter& answer) {
  const auto field = [&](const char* one, const char* many, const auto& write) {
    answer.key(list ? many : one);
    if (list) answer.begin_array();
    for (const PolygonDepth& a : answers) write(a);
    if (list) answer.end_array();
  };
  field("class", "classes", [&](const PolygonDepth& a) { answer.string(to_string(a.contact)); });
  field("depth", "depths", [&](const PolygonDepth& a) { answer.number(a.depth); });
  field("lower", "lowers", [&](const PolygonDepth& a) { answer.number(a.lower); });
  field("upper", "uppers", [&](const PolygonDepth& a) { answer.number(a.upper); });
  field("translation", "translations", [&](const PolygonDepth& a) { write_point(a.translation, answer); });
  field("normal", "normals", [&](const PolygonDepth& a) { write_point(a.normal, answer); });
  field("feature", "features", [&](const PolygonDepth& a) { write_feature(a.feature, answer); });
}

void write_statistics(const PolygonDifference& r, std::int64_t nanoseconds, JsonWriter& answer) {
  const PolygonDifference::Statistics s = r.statistics();
  answer.key("method").string(s.implicit ? "implicit" : "explicit");
  answer.key("stats").begin_object();
  answer.key("sums").integer(s.sums);
  answer.key("stretches").integer(s.stretches);
  answer.key("arcs").integer(s.arcs);
  answer.key("events").integer(s.reflex_points);
  answer.key("holes").integer(s.loops - 1);
  answer.key("pairs").integer(s.pairs);
  answer.key("probes").integer(s.locations);
  answer.key("bytes").integer(s.memory_bytes);
  answer.key("nanoseconds").integer(nanoseconds);
  answer.end_object();
}

}  // namespace

void answer_polygon_depth(const Node& line, Session& session, JsonWriter& answer) {
  allow_only(line,
             {"id", "query", "p", "q", "direction", "method", "complete", "direction_set", "placements", "slots"});
  const Question question = read_question(line);
  const PolygonMethod method = read_polygon_method(line);
  const bool slots = read_flag(line, "slots");
  std::vector<Point2> placements = {{0, 0}};
  const auto placements_node = line.find("placements");
  if (placements_node) placements = read_points2(*placements_node, session.limits, false);
  const std::size_t directions = std::max<std::size_t>(1, question.directions.size());
  if (placements.size() * directions > static_cast<std::size_t>(session.limits.max_vertices)) {
    line.refuse("limit_exceeded", "more answers than --max-vertices");
  }
  const Polygon p = read_polygon(line.at("p"), session.limits), q = read_polygon(line.at("q"), session.limits);
  const bool one_convex = p.convex() || q.convex();
  if (!one_convex || method == PolygonMethod::explicit_sums) {
    const std::int64_t sums = static_cast<std::int64_t>(p.num_vertices()) * q.num_vertices();
    if (sums > kMostSums)
      line.refuse("limit_exceeded", "more than 2^20 sums of two triangles; one polygon convex needs none");
  }
  const Stopwatch watch;
  const Expected<PolygonDifference> r = PolygonDifference::of(p, q, method);
  if (!r) line.refuse(r.error());
  std::vector<PolygonDepth> answers;
  for (const Point2& y : placements) {
    for (std::size_t d = 0; d < directions; ++d) answers.push_back(question.answer(*r, y, d));
  }
  const std::int64_t nanoseconds = watch.nanoseconds();
  write_answers(answers, placements_node.has_value() || line.find("direction_set").has_value(), answer);
  if (slots) {
    answer.key("slots").begin_array();
    for (const auto& slot : r->slots()) {
      answer.begin_array();
      write_point(slot[0], answer);
      write_point(slot[1], answer);
      answer.end_array();
    }
    answer.end_array();
  }
  write_statistics(*r, nanoseconds, answer);
}

}  // namespace pd::query
