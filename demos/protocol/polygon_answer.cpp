#include "protocol/polygon_answer.hpp"

#include <optional>
#include <string>

namespace pd::query {

void write_point2(const Point2& x, JsonWriter& answer) { answer.begin_array().number(x[0]).number(x[1]).end_array(); }

namespace {

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

}  // namespace

void write_polygon_answers(const std::vector<PolygonDepth>& answers, const std::vector<bool>& seats, bool list,
                           JsonWriter& answer) {
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
  field("translation", "translations", [&](const PolygonDepth& a) { write_point2(a.translation, answer); });
  field("normal", "normals", [&](const PolygonDepth& a) { write_point2(a.normal, answer); });
  field("feature", "features", [&](const PolygonDepth& a) { write_feature(a.feature, answer); });
  if (seats.empty()) return;
  answer.key(list ? "seats" : "seat");
  if (list) answer.begin_array();
  for (const bool seat : seats) answer.boolean(seat);
  if (list) answer.end_array();
}

void write_seats(const PolygonDifference::Seats& seats, JsonWriter& answer) {
  answer.key("slots").begin_array();
  for (const auto& slot : seats.slots) {
    answer.begin_array();
    write_point2(slot[0], answer);
    write_point2(slot[1], answer);
    answer.end_array();
  }
  answer.end_array();
  answer.key("seat_points").begin_array();
  for (const Point2& x : seats.points) write_point2(x, answer);
  answer.end_array();
}

void write_polygon_statistics(const PolygonDifference& r, std::int64_t nanoseconds, JsonWriter& answer) {
  const PolygonDifference::Statistics s = r.statistics();
  answer.key("method").string(s.implicit ? "implicit" : "explicit");
  answer.key("stats").begin_object();
  answer.key("sums").integer(s.sums);
  answer.key("stretches").integer(s.stretches);
  answer.key("arcs").integer(s.arcs);
  answer.key("events").integer(s.reflex_points);
  answer.key("most_events").integer(s.reflex_bound);
  answer.key("crossings").integer(s.crossings);
  answer.key("crossings_of_two_sums").integer(s.most_crossings);
  answer.key("facts_hold").boolean(s.facts_hold);
  answer.key("holes").integer(s.loops - 1);
  answer.key("pairs").integer(s.pairs);
  answer.key("probes").integer(s.locations);
  answer.key("bytes").integer(s.memory_bytes);
  answer.key("nanoseconds").integer(nanoseconds);
  answer.end_object();
}

}  // namespace pd::query
