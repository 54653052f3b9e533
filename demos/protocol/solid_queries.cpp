#include "protocol/solid_queries.hpp"

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <string>

#include "protocol/pair_reader.hpp"
#include "protocol/solid_reader.hpp"
#include "protocol/union_queries.hpp"

namespace pd::query {

void write_solid_answer(const SolidDepth& result, std::int64_t nanoseconds, JsonWriter& answer) {
  write_depth_fields(result, answer);
  answer.key("feature");
  if (result.face_a < 0 || result.face_b < 0) {
    answer.null();
  } else {
    answer.begin_object().key("kind").string("face-face");
    answer.key("a").begin_array().integer(result.face_a).end_array();
    answer.key("b").begin_array().integer(result.face_b).end_array();
    answer.end_object();
  }
  answer.key("method").string("solid");
  answer.key("exact").boolean(result.exact);
  answer.key("stats").begin_object();
  answer.key("triangle_pairs").integer(result.work.triangle_pairs);
  answer.key("parts_a").integer(result.work.parts_a);
  answer.key("parts_b").integer(result.work.parts_b);
  answer.key("points").integer(result.work.points);
  answer.key("nanoseconds").integer(nanoseconds);
  answer.end_object();
}

Expected<SolidDepth> depth_beside_solid(const SolidOrShape& a, const SolidOrShape& b, Scratch& scratch,
                                        const SolidSettings& settings) {
  const PosedSolid solid_a{a.solid, a.pose}, solid_b{b.solid, b.pose};
  if (b.shape != nullptr) return penetration_depth(solid_a, PosedShape{b.shape, b.pose}, scratch, settings);
  if (a.shape != nullptr) return penetration_depth(PosedShape{a.shape, a.pose}, solid_b, scratch, settings);
  return penetration_depth(solid_a, solid_b, scratch, settings);
}

void write_seat(const PosedSolid& a, const PosedSolid& b, JsonWriter& answer) {
  const Expected<bool> seat = is_seat(a, b);
  answer.key("seat");
  if (seat) {
    answer.boolean(*seat);
  } else {
    answer.null();
  }
}

namespace {

/// Two bodies where they stand, each a solid or a convex shape that is none.
struct SolidPair {
  std::shared_ptr<const MeshSolid> a, b;
  std::optional<ConvexShape> shape_a, shape_b;
  Pose pose_a, pose_b;

  [[nodiscard]] SolidOrShape body_a() const { return {a.get(), shape_a ? &*shape_a : nullptr, pose_a}; }
  [[nodiscard]] SolidOrShape body_b() const { return {b.get(), shape_b ? &*shape_b : nullptr, pose_b}; }
  /// False for unions, flat polytopes, and two shapes.
  [[nodiscard]] bool is_answered() const { return (a && (b || shape_b)) || (b && shape_a); }
};

SolidPair read_solids(const Node& line, const Limits& limits) {
  const Node a = line.at("a"), b = line.at("b");
  SolidPair pair{read_as_solid(a, limits), read_as_solid(b, limits), {}, {}, {}, {}};
  if (!pair.a && pair.b) pair.shape_a = read_beside_solid(a, limits);
  if (!pair.b && pair.a) pair.shape_b = read_beside_solid(b, limits);
  pair.pose_a = read_optional_pose(line, "pose_a");
  pair.pose_b = read_optional_pose(line, "pose_b");
  return pair;
}

void answer_by_union(std::string_view query, const Node& line, Session& session, JsonWriter& answer) {
  find_union_handler(query)(line, session, answer);
}

void answer_solids(const SolidPair& pair, const SolidSettings& settings, const Node& line, Session& session,
                   JsonWriter& answer) {
  const Stopwatch watch;
  const SolidDepth result =
      value_or_refuse(depth_beside_solid(pair.body_a(), pair.body_b(), session.scratch, settings), line);
  write_solid_answer(result, watch.nanoseconds(), answer);
  if (result.contact != ContactClass::touching || !pair.a || !pair.b) return;
  write_seat({pair.a.get(), pair.pose_a}, {pair.b.get(), pair.pose_b}, answer);
}

void answer_solid_depth(const Node& line, Session& session, JsonWriter& answer) {
  allow_only(line, {"id", "query", "a", "pose_a", "b", "pose_b", "method", "delta", "metric", "seed", "max_points"});
  if (const auto node = line.find("method"); node && read_method(*node) != Method::automatic) {
    node->refuse("unsupported", "solids are answered by \"auto\"");
  }
  if (const auto node = line.find("metric")) {
    node->refuse("unsupported", "a polyhedral metric is for convex polytopes; here lengths are Euclidean");
  }
  if (const auto seed = line.find("seed")) (void)read_integer(*seed, 0, std::int64_t{1} << 53);
  SolidSettings settings;
  if (const auto delta = line.find("delta")) settings.delta = read_delta(*delta);
  settings.max_points = read_max_points(line);
  const SolidPair pair = read_solids(line, session.limits);
  if (!pair.is_answered()) return answer_by_union("depth", line, session, answer);
  answer_solids(pair, settings, line, session, answer);
}

void answer_solid_distance(const Node& line, Session& session, JsonWriter& answer) {
  allow_only(line, {"id", "query", "a", "pose_a", "b", "pose_b"});
  const SolidPair pair = read_solids(line, session.limits);
  if (!pair.is_answered()) return answer_by_union("distance", line, session, answer);
  answer_solids(pair, {}, line, session, answer);
}

void answer_solid_intersect(const Node& line, Session& session, JsonWriter& answer) {
  allow_only(line, {"id", "query", "a", "pose_a", "b", "pose_b"});
  const SolidPair pair = read_solids(line, session.limits);
  if (!pair.is_answered()) return answer_by_union("intersect", line, session, answer);
  const auto class_of = [&]() -> Expected<ContactClass> {
    if (pair.shape_b) return classify({pair.a.get(), pair.pose_a}, {&*pair.shape_b, pair.pose_b}, session.scratch);
    if (pair.shape_a) return classify({pair.b.get(), pair.pose_b}, {&*pair.shape_a, pair.pose_a}, session.scratch);
    return classify({pair.a.get(), pair.pose_a}, {pair.b.get(), pair.pose_b});
  };
  answer.key("class").string(to_string(value_or_refuse(class_of(), line)));
}

constexpr std::array kSolidQueries{
    QueryEntry{"depth", answer_solid_depth},
    QueryEntry{"distance", answer_solid_distance},
    QueryEntry{"intersect", answer_solid_intersect},
};

}  // namespace

Handler find_solid_handler(std::string_view query) {
  const auto found = std::find_if(kSolidQueries.begin(), kSolidQueries.end(),
                                  [&](const QueryEntry& entry) { return entry.name == query; });
  return found == kSolidQueries.end() ? find_union_handler(query) : found->handler;
}

}  // namespace pd::query
