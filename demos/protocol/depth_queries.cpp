/// @file
/// depth, distance, intersect.
#include <array>
#include <utility>

#include "pd/depth/difference_queries.hpp"
#include "pd/depth/linear_separation.hpp"
#include "pd/depth/polyhedral_depth.hpp"
#include "pd/solid/solid_depth.hpp"
#include "protocol/pair_reader.hpp"

namespace pd::query {

namespace {

constexpr std::array kMethods{
    std::pair{std::string_view("auto"), Method::automatic},
    std::pair{std::string_view("expansion"), Method::expansion},
    std::pair{std::string_view("overlay"), Method::overlay},
    std::pair{std::string_view("decomposition"), Method::decomposition},
    std::pair{std::string_view("shallow"), Method::shallow},
    std::pair{std::string_view("grid"), Method::grid},
};

std::string_view word_of(Feature::Kind kind) {
  switch (kind) {
    case Feature::Kind::vertex:
      return "vertex";
    case Feature::Kind::edge:
      return "edge";
    case Feature::Kind::facet:
      return "facet";
    case Feature::Kind::none:
      break;
  }
  return {};
}

void write_ids(const Feature& feature, const NamedShape& shape, JsonWriter& answer) {
  answer.begin_array();
  for (const int id : feature_ids(feature, shape)) answer.integer(id);
  answer.end_array();
}

}  // namespace

Method read_method(const Node& node) {
  const std::string word = read_string(node);
  std::string known;
  for (const auto& [name, method] : kMethods) {
    if (word == name) return method;
    known += (known.empty() ? "" : ", ") + std::string(name);
  }
  if (word == "metric") node.refuse("missing_field", "the method \"metric\" needs the field \"metric\"");
  node.refuse("bad_value", "unknown method; known: " + known + ", metric");
}

double read_delta(const Node& node) {
  const double delta = read_number(node);
  if (!(delta > 0 && delta <= 1)) node.refuse("bad_value", "delta must lie in (0, 1]");
  return delta;
}

std::int64_t read_max_points(const Node& line) {
  const auto node = line.find("max_points");
  return node ? read_integer(*node, 1, std::int64_t{1} << 40) : SolidSettings().max_points;
}

void write_statistics(const Statistics& statistics, std::int64_t nanoseconds, JsonWriter& answer) {
  answer.key("stats").begin_object();
  answer.key("support_calls").integer(statistics.support_calls);
  answer.key("facets_visited").integer(statistics.facets_visited);
  answer.key("exact_signs").integer(statistics.exact_signs);
  answer.key("pair_evaluations").integer(statistics.pair_evaluations);
  answer.key("block_bounds").integer(statistics.block_bounds);
  answer.key("lines_scanned").integer(statistics.lines_scanned);
  answer.key("nanoseconds").integer(nanoseconds);
  answer.end_object();
}

Pose read_optional_pose(const Node& line, std::string_view key) {
  const auto node = line.find(key);
  return node ? read_pose(*node) : Pose();
}

Pair read_pair(const Node& line, const Limits& limits) {
  return {read_shape(line.at("a"), limits), read_shape(line.at("b"), limits), read_optional_pose(line, "pose_a"),
          read_optional_pose(line, "pose_b")};
}

std::vector<int> feature_ids(const Feature& feature, const NamedShape& shape) {
  switch (feature.kind) {
    case Feature::Kind::vertex:
      return {shape.caller_id(feature.first)};
    case Feature::Kind::edge:
      return {shape.caller_id(feature.first), shape.caller_id(feature.second)};
    case Feature::Kind::facet: {
      std::vector<int> ids;
      for (const std::int32_t v : shape.shape.polytope()->facet_vertices(feature.first)) {
        ids.push_back(shape.caller_id(v));
      }
      return ids;
    }
    case Feature::Kind::none:
      break;
  }
  return {};
}

std::string feature_kind(const PenetrationDepth& result) {
  const std::string_view a = word_of(result.feature_a.kind);
  const std::string_view b = word_of(result.feature_b.kind);
  if (a.empty() || b.empty()) return {};
  return std::string(a) + "-" + std::string(b);
}

void write_body_note(std::string_view body, std::string_view is, std::int64_t left_out, JsonWriter& answer) {
  answer.key(std::string(body) + "_is").string(is);
  if (left_out > 0) answer.key(std::string(body) + "_points_left_out").integer(left_out);
}

void write_hull_note(std::string_view body, const NamedShape& shape, JsonWriter& answer) {
  if (shape.hull_note) write_body_note(body, "hull", shape.hull_note->left_out, answer);
}

void write_depth_fields(const PenetrationDepth& result, JsonWriter& answer) {
  answer.key("class").string(to_string(result.contact));
  answer.key("depth").number(result.depth);
  answer.key("lower").number(result.lower);
  answer.key("upper").number(result.upper);
  answer.key("distance").number(result.distance);
  if (result.contact == ContactClass::separated) {
    answer.key("distance_lower").number(result.distance_lower);
    answer.key("distance_upper").number(result.distance_upper);
  }
  if (!result.bracket_reached) answer.bracket_unreached();
  answer.key("translation").vector(result.translation);
  answer.key("normal").vector(result.normal);
  answer.key("witness_a").vector(result.witness_a);
  answer.key("witness_b").vector(result.witness_b);
}

void write_depth_answer(const PenetrationDepth& result, const NamedShape& a, const NamedShape& b,
                        std::int64_t nanoseconds, JsonWriter& answer, std::string_view method) {
  write_depth_fields(result, answer);
  const std::string kind = feature_kind(result);
  answer.key("feature");
  if (kind.empty() || a.shape.polytope() == nullptr || b.shape.polytope() == nullptr) {
    answer.null();
  } else {
    answer.begin_object().key("kind").string(kind);
    answer.key("a");
    write_ids(result.feature_a, a, answer);
    answer.key("b");
    write_ids(result.feature_b, b, answer);
    answer.end_object();
  }
  answer.key("method").string(method.empty() ? to_string(result.method) : method);
  write_statistics(result.statistics, nanoseconds, answer);
}

namespace {

/// Rays that one line may ask of a grid: seconds of work.
constexpr std::int64_t kMostRays = std::int64_t{1} << 20;

/// "metric": the depth under the gauge of a convex polytope round the origin.
void answer_metric_depth(const Node& line, const Node& metric, Session& session, JsonWriter& answer) {
  if (const auto method = line.find("method")) {
    const std::string word = read_string(*method);
    if (word != "metric" && word != "auto") {
      method->refuse("bad_value", "a metric is answered by the method \"metric\" (or \"auto\")");
    }
  }
  const Pair pair = read_pair(line, session.limits);
  require_object(metric);
  allow_only(metric, {"vertices"});
  const Node vertices = metric.at("vertices");
  const std::vector<Vec3> points = read_points(vertices, session.limits.max_vertices);
  const Expected<ConvexPolytope> ball = ConvexPolytope::from_points(points);
  if (!ball) metric.refuse(ball.error());
  const Stopwatch watch;
  const Expected<PenetrationDepth> result = polyhedral_depth(pair.posed_a(), pair.posed_b(), *ball, session.scratch);
  if (!result) {
    const Error& error = result.error();
    (error.where == "metric" ? metric : line).refuse(to_string(error.code), error.message);
  }
  write_depth_answer(*result, pair.a, pair.b, watch.nanoseconds(), answer, "metric");
}

}  // namespace

void answer_depth(const Node& line, Session& session, JsonWriter& answer) {
  allow_only(line, {"id", "query", "a", "pose_a", "b", "pose_b", "method", "delta", "metric", "seed", "max_points"});
  (void)read_max_points(line);
  if (const auto metric = line.find("metric")) {
    if (const auto delta_node = line.find("delta")) (void)read_delta(*delta_node);
    if (const auto seed = line.find("seed")) (void)read_integer(*seed, 0, std::int64_t{1} << 53);
    answer_metric_depth(line, *metric, session, answer);
    return;
  }
  DepthSettings settings;
  settings.bracket = Bracket::tightest;
  const auto method_node = line.find("method");
  if (method_node) settings.method = read_method(*method_node);
  double delta = 0;
  if (const auto delta_node = line.find("delta")) delta = read_delta(*delta_node);
  if (const auto seed = line.find("seed")) {
    settings.seed = static_cast<std::uint64_t>(read_integer(*seed, 0, std::int64_t{1} << 53));
  }
  const Pair pair = read_pair(line, session.limits);
  // (Rounded) polytopes are answered exactly, which is within every delta, but where delta steers the method.
  const bool smooth = pair.a.shape.polytope() == nullptr || pair.b.shape.polytope() == nullptr;
  if (smooth || settings.method == Method::grid || settings.method == Method::shallow) settings.delta = delta;
  if (!supports(settings.method, pair.a.shape, pair.b.shape)) {
    method_node->refuse("unsupported", "the method \"" + std::string(to_string(settings.method)) +
                                           "\" does not answer for these shapes; \"auto\" does");
  }
  // About 11 / delta rays.
  if (settings.method == Method::shallow && delta > 0 && 11 / delta > static_cast<double>(kMostRays)) {
    line.at("delta").refuse("limit_exceeded",
                            "the method \"shallow\" shoots about 11 / delta rays, more than 2^20 here; "
                            "its answer is exact for every delta, 0.25 is a good one");
  }
  const Stopwatch watch;
  const PenetrationDepth result = penetration_depth(pair.posed_a(), pair.posed_b(), session.scratch, settings);
  write_depth_answer(result, pair.a, pair.b, watch.nanoseconds(), answer);
}

void answer_distance(const Node& line, Session& session, JsonWriter& answer) {
  allow_only(line, {"id", "query", "a", "pose_a", "b", "pose_b"});
  const Pair pair = read_pair(line, session.limits);
  const Stopwatch watch;
  const PenetrationDepth result = penetration_depth(pair.posed_a(), pair.posed_b(), session.scratch,
                                                    {.method = Method::automatic, .bracket = Bracket::tightest});
  write_depth_answer(result, pair.a, pair.b, watch.nanoseconds(), answer);
}

void answer_intersect(const Node& line, Session& session, JsonWriter& answer) {
  allow_only(line, {"id", "query", "a", "pose_a", "b", "pose_b"});
  const Pair pair = read_pair(line, session.limits);
  const PenetrationDepth result = penetration_depth(pair.posed_a(), pair.posed_b(), session.scratch, {.beyond = 0});
  answer.key("class").string(to_string(result.contact));
  if (result.contact != ContactClass::separated) return;
  // The normal points from B to A. A gap below the rounding of a unit vector may have no direction that separates as
  // stored: of polytopes an exact linear program looks for one, and then none is claimed.
  Vec3 direction = -result.normal;
  const auto support = support_of_difference(pair.posed_a(), pair.posed_b(), -direction);
  bool strict = support && support->value < 0;
  const ConvexPolytope* const a = pair.a.shape.polytope();
  const ConvexPolytope* const b = pair.b.shape.polytope();
  if (!strict && a != nullptr && b != nullptr && pair.a.shape.margin() == 0 && pair.b.shape.margin() == 0) {
    const LinearSeparation found = linear_separation(*a, pair.pose_a, *b, pair.pose_b);
    strict = found.strict;
    direction = found.direction;
  }
  if (strict) answer.key("separating_direction").vector(direction);
}

}  // namespace pd::query
