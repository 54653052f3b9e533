/// @file
/// polygon_depth: two polygons of the plane, Q moves ([D] section 4).
#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "pd/planar/direction_set.hpp"
#include "protocol/pair_reader.hpp"
#include "protocol/polygon_answer.hpp"
#include "protocol/polygon_reader.hpp"

namespace pd::query {

namespace {

/// Explicit sums are one for every two convex parts at most; a line may not ask for more.
constexpr std::int64_t kMostSums = 1 << 20;

/// Placements from which on a direction of a set is cut into trapezoids, which costs some dozens of rays an edge.
constexpr std::size_t kWorthPreprocessing = 64;

PolygonMethod read_polygon_method(const Node& line) {
  const auto node = line.find("method");
  if (!node) return PolygonMethod::automatic;
  const std::string word = read_string(*node);
  if (word == "auto") return PolygonMethod::automatic;
  if (word == "implicit") return PolygonMethod::implicit;
  if (word == "explicit") return PolygonMethod::explicit_sums;
  node->refuse("bad_value", "unknown method; known: auto, implicit, explicit");
}

std::int64_t read_max_comparisons(const Node& line) {
  const auto node = line.find("max_comparisons");
  return node ? read_integer(*node, 1, std::int64_t{1} << 40) : kPolygonComparisons;
}

/// What a line asks of every placement.
struct Question {
  Leave leave = Leave::first_exit;
  std::vector<Point2> directions;  ///< empty: the least over all
  bool fixed_set = false;          ///< given as a "direction_set"
  PlanarMargins margins = {};

  [[nodiscard]] bool swept() const { return margins.p > 0 || margins.q > 0; }

  /// Of every placement, direction after direction.
  [[nodiscard]] std::vector<PolygonDepth> answers(const PolygonDifference& r, const std::vector<Point2>& placements,
                                                  const Node& line) const {
    const std::size_t count = std::max<std::size_t>(1, directions.size());
    std::vector<PolygonDepth> found(placements.size() * count);
    for (std::size_t d = 0; d < count; ++d) {
      std::optional<DirectionSet> trapezoids;  // [D] section 6; of one direction at a time, for the sake of memory
      if (fixed_set && !swept() && leave == Leave::first_exit && placements.size() >= kWorthPreprocessing) {
        auto made = DirectionSet::of(r, {&directions[d], 1});
        if (!made) line.refuse(made.error());
        trapezoids = std::move(*made);
      }
      for (std::size_t i = 0; i < placements.size(); ++i) {
        found[i * count + d] = trapezoids ? trapezoids->depth(placements[i], 0) : answer(r, placements[i], d, line);
      }
    }
    return found;
  }
  /// Tells for every answer whether Q fits exactly there; empty for swept polygons, of which nothing is said.
  [[nodiscard]] std::vector<bool> seats(const PolygonDifference& r, const std::vector<Point2>& placements) const {
    std::vector<bool> found;
    if (swept()) return found;
    for (const Point2& y : placements) {
      found.insert(found.end(), std::max<std::size_t>(1, directions.size()), r.seat(y));
    }
    return found;
  }

 private:
  [[nodiscard]] PolygonDepth answer(const PolygonDifference& r, const Point2& y, std::size_t direction,
                                    const Node& line) const {
    if (swept()) {
      const Expected<PolygonDepth> found = directions.empty()
                                               ? r.swept_depth(y, margins, leave)
                                               : r.swept_depth_along(y, directions[direction], margins, leave);
      if (!found) line.refuse(found.error());
      return *found;
    }
    if (!directions.empty()) return r.depth_along(y, directions[direction], leave);
    if (leave == Leave::straight) return r.straight_escape_depth(y);
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
  Question question;
  question.leave = read_leave(line);
  const auto direction = line.find("direction");
  const auto set = line.find("direction_set");
  if (direction && set) set->refuse("bad_value", "give either \"direction\" or \"direction_set\"");
  if (direction) question.directions = {read_direction2(*direction)};
  if (set) {
    question.directions = read_points2(*set, {}, true);
    if (question.directions.empty()) set->refuse("bad_value", "needs a direction at least");
    question.fixed_set = true;
  }
  return question;
}

}  // namespace

void answer_polygon_depth(const Node& line, Session& session, JsonWriter& answer) {
  allow_only(line, {"id", "query", "p", "q", "direction", "method", "complete", "direction_set", "placements", "slots",
                    "max_comparisons"});
  Question question = read_question(line);
  const PolygonMethod method = read_polygon_method(line);
  const bool slots = read_flag(line, "slots");
  const std::int64_t max_comparisons = read_max_comparisons(line);
  std::vector<Point2> placements = {{0, 0}};
  const auto placements_node = line.find("placements");
  if (placements_node) placements = read_points2(*placements_node, session.limits, false);
  const std::size_t directions = std::max<std::size_t>(1, question.directions.size());
  if (placements.size() * directions > static_cast<std::size_t>(session.limits.max_vertices)) {
    line.refuse("limit_exceeded", "more answers than --max-vertices");
  }
  const SweptPolygon swept_p = read_polygon(line.at("p"), session.limits);
  const SweptPolygon swept_q = read_polygon(line.at("q"), session.limits);
  const Polygon &p = swept_p.polygon, &q = swept_q.polygon;
  question.margins = {swept_p.margin, swept_q.margin};
  if (slots && question.swept()) {
    line.at("slots").refuse("unsupported", "slots are listed for polygons without a margin");
  }
  const bool one_convex = p.convex() || q.convex();
  if (!one_convex || method == PolygonMethod::explicit_sums) {
    const std::int64_t sums = static_cast<std::int64_t>(p.num_vertices()) * q.num_vertices();
    if (sums > kMostSums) {
      line.refuse("limit_exceeded", "more than 2^20 sums of two convex parts; one polygon convex needs none");
    }
  }
  const Stopwatch watch;
  const Expected<PolygonDifference> r = PolygonDifference::of(p, q, method, max_comparisons);
  if (!r) line.refuse(r.error());
  const std::vector<PolygonDepth> answers = question.answers(*r, placements, line);
  const std::int64_t nanoseconds = watch.nanoseconds();
  write_polygon_answers(answers, question.seats(*r, placements), placements_node.has_value() || question.fixed_set,
                        answer);
  if (slots) write_seats(r->seats(), answer);
  write_polygon_statistics(*r, nanoseconds, answer);
}

}  // namespace pd::query
