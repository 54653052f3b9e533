#include "protocol/union_queries.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "pd/compound/compound_difference.hpp"
#include "pd/depth/difference_queries.hpp"
#include "protocol/pair_reader.hpp"

namespace pd::query {

namespace {

void write_ids(std::string_view key, const std::vector<int>& ids, JsonWriter& answer) {
  answer.key(key).begin_array();
  for (const int id : ids) answer.integer(id);
  answer.end_array();
}

void write_work(const Statistics& statistics, const UnionStatistics& work, std::int64_t nanoseconds,
                JsonWriter& answer) {
  answer.key("stats").begin_object();
  answer.key("support_calls").integer(statistics.support_calls);
  answer.key("facets_visited").integer(statistics.facets_visited);
  answer.key("exact_signs").integer(statistics.exact_signs);
  answer.key("pairs").integer(work.pairs);
  answer.key("facets").integer(work.facets);
  answer.key("polygons").integer(work.polygons);
  answer.key("cuts").integer(work.cuts);
  answer.key("cells").integer(work.cells);
  answer.key("nanoseconds").integer(nanoseconds);
  answer.end_object();
}

}  // namespace

BodyPair read_bodies(const Node& line, const Limits& limits) {
  return {read_body(line.at("a"), limits), read_body(line.at("b"), limits), read_optional_pose(line, "pose_a"),
          read_optional_pose(line, "pose_b")};
}

void write_union_answer(const UnionDepth& result, const BodyPair& pair, std::int64_t nanoseconds, JsonWriter& answer) {
  write_depth_fields(result, answer);
  const std::string kind = feature_kind(result);
  answer.key("feature");
  if (kind.empty()) {
    answer.null();
  } else {
    answer.begin_object().key("kind").string(kind);
    write_ids("a", pair.a.feature_ids(result.part_a, result.feature_a), answer);
    write_ids("b", pair.b.feature_ids(result.part_b, result.feature_b), answer);
    answer.key("part_a").integer(result.part_a);
    answer.key("part_b").integer(result.part_b);
    answer.end_object();
  }
  answer.key("method").string(to_string(result.method));
  answer.key("exact").boolean(result.exact);
  answer.key("closed").boolean(result.closed);
  write_work(result.statistics, result.work, nanoseconds, answer);
}

namespace {

UnionDepth solve(const Node& line, const BodyPair& pair, Session& session, const UnionSettings& settings) {
  return value_or_refuse(penetration_depth(pair.posed_a(), pair.posed_b(), session.scratch, settings), line);
}

void answer_union_depth(const Node& line, Session& session, JsonWriter& answer) {
  allow_only(line, {"id", "query", "a", "pose_a", "b", "pose_b", "method", "delta", "metric", "seed", "max_points"});
  (void)read_max_points(line);
  UnionSettings settings;
  if (const auto node = line.find("method"); node && read_method(*node) != Method::automatic) {
    node->refuse("unsupported", "compounds and star-shaped bodies are answered by \"auto\"");
  }
  if (const auto node = line.find("delta")) settings.delta = read_delta(*node);
  if (const auto seed = line.find("seed")) (void)read_integer(*seed, 0, std::int64_t{1} << 53);
  if (const auto node = line.find("metric")) {
    node->refuse("unsupported", "a polyhedral metric is for convex polytopes; here lengths are Euclidean");
  }
  settings.max_facets = session.limits.max_vertices;
  const BodyPair pair = read_bodies(line, session.limits);
  const Stopwatch watch;
  const UnionDepth result = solve(line, pair, session, settings);
  write_union_answer(result, pair, watch.nanoseconds(), answer);
}

void answer_union_distance(const Node& line, Session& session, JsonWriter& answer) {
  allow_only(line, {"id", "query", "a", "pose_a", "b", "pose_b"});
  const BodyPair pair = read_bodies(line, session.limits);
  const Stopwatch watch;
  const UnionDepth result = solve(line, pair, session, {});
  write_union_answer(result, pair, watch.nanoseconds(), answer);
}

void answer_union_intersect(const Node& line, Session& session, JsonWriter& answer) {
  allow_only(line, {"id", "query", "a", "pose_a", "b", "pose_b"});
  const BodyPair pair = read_bodies(line, session.limits);
  // Two bodies that are apart need not be apart by a plane, so that no separating direction is named.
  const ContactClass contact =
      value_or_refuse(point_in_difference(pair.posed_a(), pair.posed_b(), Vec3::Zero(), session.scratch), line);
  answer.key("class").string(to_string(contact));
}

void answer_union_point_in_difference(const Node& line, Session& session, JsonWriter& answer) {
  allow_only(line, {"id", "query", "a", "pose_a", "b", "pose_b", "points"});
  const BodyPair pair = read_bodies(line, session.limits);
  const Node points_node = line.at("points");
  const std::vector<Vec3> points = read_points(points_node, session.limits.max_vertices);
  std::vector<ContactClass> classes;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto where = point_in_difference(pair.posed_a(), pair.posed_b(), points[i], session.scratch);
    if (!where) points_node.element(i).refuse(to_string(where.error().code), where.error().message);
    classes.push_back(*where);
  }
  answer.key("classes").begin_array();
  for (const ContactClass contact : classes) answer.string(to_string(contact));
  answer.end_array();
}

void answer_union_directional_depth(const Node& line, Session& session, JsonWriter& answer) {
  allow_only(line, {"id", "query", "a", "pose_a", "b", "pose_b", "direction", "method"});
  if (const auto node = line.find("method"); node && read_string(*node) != "overlay") {
    node->refuse("unsupported", "compounds and star-shaped bodies are answered by \"overlay\" (or without a method)");
  }
  const BodyPair pair = read_bodies(line, session.limits);
  const Node direction_node = line.at("direction");
  const Vec3 direction = read_vector(direction_node);
  UnionSettings settings;
  settings.max_facets = session.limits.max_vertices;
  const Stopwatch watch;
  const UnionDirectionalDepth result =
      value_or_refuse(directional_depth(pair.posed_a(), pair.posed_b(), direction, session.scratch, settings), line);
  const std::int64_t nanoseconds = watch.nanoseconds();
  answer.key("depth").number(result.depth);
  answer.key("lower").number(result.lower);
  answer.key("upper").number(result.upper);
  answer.key("class").string(to_string(result.contact));
  answer.key("part_a").integer(result.part_a);
  answer.key("part_b").integer(result.part_b);
  write_work({}, result.work, nanoseconds, answer);
}

/// The support of a union is the largest of its parts'.
void answer_union_support(const Node& line, Session& session, JsonWriter& answer) {
  allow_only(line, {"id", "query", "a", "pose_a", "b", "pose_b", "directions"});
  const BodyPair pair = read_bodies(line, session.limits);
  const Node directions_node = line.at("directions");
  const std::vector<Vec3> directions = read_points(directions_node, session.limits.max_vertices);
  const std::vector<PosedShape> parts_a = value_or_refuse(pair.a.compound.posed(pair.pose_a), line);
  const std::vector<PosedShape> parts_b = value_or_refuse(pair.b.compound.posed(pair.pose_b), line);
  struct Best {
    DifferenceSupport support;
    int part_a = 0;
    int part_b = 0;
  };
  std::vector<Best> found;
  for (std::size_t d = 0; d < directions.size(); ++d) {
    Best best;
    // Over all pairs, so that the value of one pair is the answer, not a sum of rounded parts.
    for (std::size_t i = 0; i < parts_a.size(); ++i) {
      for (std::size_t j = 0; j < parts_b.size(); ++j) {
        const auto one = support_of_difference(parts_a[i], parts_b[j], directions[d]);
        if (!one) directions_node.element(d).refuse(to_string(one.error().code), one.error().message);
        if ((i == 0 && j == 0) || one->value > best.support.value) {
          best = {*one, static_cast<int>(i), static_cast<int>(j)};
        }
      }
    }
    if (!std::isfinite(best.support.value)) {
      directions_node.element(d).refuse("out_of_range",
                                        "the support is past the double range; give a shorter direction");
    }
    found.push_back(best);
  }
  const auto write_integers = [&](std::string_view key, const auto& value) {
    answer.key(key).begin_array();
    for (const Best& best : found) {
      const std::int64_t id = value(best);
      if (id >= 0) {
        answer.integer(id);
      } else {
        answer.null();  // a point of a curved part, or the centre of a star-shaped body
      }
    }
    answer.end_array();
  };
  const auto caller_id = [](const NamedBody& body, int part, int vertex) {
    return vertex < 0 ? -1 : body.parts[static_cast<std::size_t>(part)].caller_id(vertex);
  };
  answer.key("values").begin_array();
  for (const Best& best : found) answer.number(best.support.value);
  answer.end_array();
  write_integers("vertices_a", [&](const Best& s) { return caller_id(pair.a, s.part_a, s.support.vertex_a); });
  write_integers("vertices_b", [&](const Best& s) { return caller_id(pair.b, s.part_b, s.support.vertex_b); });
  write_integers("parts_a", [](const Best& s) { return s.part_a; });
  write_integers("parts_b", [](const Best& s) { return s.part_b; });
}

std::string_view word_of_facet(Feature::Kind kind) {
  return kind == Feature::Kind::facet ? "facet" : kind == Feature::Kind::edge ? "edge" : "vertex";
}

}  // namespace

std::int64_t read_max_work(const Node& line) {
  const auto node = line.find("max_work");
  return node ? read_integer(*node, 1, std::int64_t{1} << 40) : kDifferenceWork;
}

namespace {

void answer_union_minkowski_difference(const Node& line, Session& session, JsonWriter& answer) {
  allow_only(line, {"id", "query", "a", "pose_a", "b", "pose_b", "max_work"});
  const BodyPair pair = read_bodies(line, session.limits);
  const std::int64_t max_work = read_max_work(line);
  const UnionDifference result = value_or_refuse(
      minkowski_difference(pair.posed_a(), pair.posed_b(), session.limits.max_vertices, max_work), line);
  answer.key("vertices").begin_array();
  for (const Vec3& vertex : result.vertices) answer.vector(vertex);
  answer.end_array();
  answer.key("facets").begin_array();
  for (const UnionDifference::Facet& facet : result.facets) {
    answer.begin_array();
    for (std::int32_t k = 0; k < facet.count; ++k) {
      answer.integer(result.corners[static_cast<std::size_t>(facet.first + k)]);
    }
    answer.end_array();
  }
  answer.end_array();
  answer.key("K").integer(static_cast<std::int64_t>(result.facets.size()));
  answer.key("facet_kinds").begin_array();
  for (const UnionDifference::Facet& facet : result.facets) {
    answer.string(std::string(word_of_facet(facet.on_a.kind)) + "-" + std::string(word_of_facet(facet.on_b.kind)));
  }
  answer.end_array();
  const auto write_parts = [&](std::string_view key, std::int32_t UnionDifference::Facet::*part) {
    answer.key(key).begin_array();
    for (const UnionDifference::Facet& facet : result.facets) answer.integer(facet.*part);
    answer.end_array();
  };
  write_parts("parts_a", &UnionDifference::Facet::part_a);
  write_parts("parts_b", &UnionDifference::Facet::part_b);
}

constexpr std::array kUnionQueries{
    QueryEntry{"depth", answer_union_depth},
    QueryEntry{"distance", answer_union_distance},
    QueryEntry{"intersect", answer_union_intersect},
    QueryEntry{"directional_depth", answer_union_directional_depth},
    QueryEntry{"point_in_difference", answer_union_point_in_difference},
    QueryEntry{"support_of_difference", answer_union_support},
    QueryEntry{"contact_manifold", answer_union_contact_manifold},
    QueryEntry{"time_of_impact", answer_union_time_of_impact},
    QueryEntry{"minkowski_difference", answer_union_minkowski_difference},
};

}  // namespace

Handler find_union_handler(std::string_view query) {
  const auto found = std::find_if(kUnionQueries.begin(), kUnionQueries.end(),
                                  [&](const QueryEntry& entry) { return entry.name == query; });
  return found == kUnionQueries.end() ? nullptr : found->handler;
}

}  // namespace pd::query
