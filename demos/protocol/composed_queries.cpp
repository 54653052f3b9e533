/// @file
/// Queries about several bodies of any dimension, and bodies composed of them: intersection, Minkowski sum, membership.
#include <vector>

#include "pd/dimension/approximate_intersection.hpp"
#include "pd/dimension/approximate_minkowski_sum.hpp"
#include "protocol/composed_body.hpp"
#include "protocol/dimension_body.hpp"
#include "protocol/handlers.hpp"
#include "protocol/pair_reader.hpp"

namespace pd::query {

namespace {

using dimension::Backend;
using dimension::ComposedBody;
using dimension::DirectionalWidth;
using dimension::Representation;
using dimension::Side;
using dimension::Vector;

/// "a" and "b", which may be a list.
template <int D>
std::vector<ComposedBody<D>> read_all(const Node& line, const Limits& limits, const Preparation& preparation) {
  std::vector<ComposedBody<D>> bodies = {read_composed<D>(line.at("a"), limits, preparation)};
  const Node b = line.at("b");
  if (!b.json().is_array()) {
    bodies.push_back(read_composed<D>(b, limits, preparation));
    return bodies;
  }
  if (b.size() == 0) b.refuse("bad_value", "an empty list of bodies; at least one is needed");
  for (std::size_t i = 0; i < b.size(); ++i) {
    bodies.push_back(read_composed<D>(b.element(i), limits, preparation));
  }
  return bodies;
}

void write_work(const dimension::QueryCounters& counters, JsonWriter& answer) {
  answer.key("queries").integer(counters.queries).key("nodes_visited").integer(counters.nodes);
  answer.key("dot_products").integer(counters.dot_products);
}

}  // namespace

void answer_approx_intersect(const Node& line, Session& session, JsonWriter& answer) {
  allow_only(line, {"id", "query", "a", "b", "epsilon", "backend"});
  const double epsilon = read_epsilon(line);
  const Backend backend = read_backend(line);
  for_dimension(composed_dimension(line.at("a"), session.limits), [&]<int D>() {
    const Stopwatch watch;
    const auto bodies = read_all<D>(line, session.limits, {epsilon / 4, backend});
    const std::int64_t prepared = watch.nanoseconds();
    const auto found = dimension::approximate_intersection<D>(bodies, epsilon);
    if (!found) line.refuse(found.error());
    const std::int64_t nanoseconds = watch.nanoseconds() - prepared;
    answer.key("intersect").boolean(found->intersect);
    answer.key("stats").begin_object();
    answer.key("support_calls").integer(found->support_calls).key("cuts").integer(found->cuts);
    write_work(found->counters, answer);
    answer.key("build_nanoseconds").integer(prepared).key("nanoseconds").integer(nanoseconds).end_object();
  });
}

void answer_approx_membership(const Node& line, Session& session, JsonWriter& answer) {
  allow_only(line, {"id", "query", "a", "epsilon", "points", "backend"});
  const double epsilon = read_epsilon(line);
  const Backend backend = read_backend(line);
  const Node a = line.at("a");
  for_dimension(composed_dimension(a, session.limits), [&]<int D>() {
    const Node nodes = line.at("points");
    require_array(nodes, "an array of points");
    std::vector<Vector<D>> points;
    for (std::size_t i = 0; i < nodes.size(); ++i) points.push_back(read_row<D>(nodes.element(i)));
    const Stopwatch watch;
    const ComposedBody<D> body = read_composed<D>(a, session.limits, {epsilon / 4, backend});
    const std::int64_t prepared = watch.nanoseconds();
    std::int64_t supports = 0;
    answer.key("inside").begin_array();
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto found = dimension::approximate_membership<D>(body, points[i], epsilon);
      if (!found) nodes.element(i).refuse(found.error());
      answer.boolean(found->intersect);
      supports += found->support_calls;
    }
    const std::int64_t nanoseconds = watch.nanoseconds() - prepared;
    answer.end_array().key("stats").begin_object();
    answer.key("support_calls").integer(supports);
    answer.key("build_nanoseconds").integer(prepared).key("nanoseconds").integer(nanoseconds).end_object();
  });
}

void answer_approx_minkowski_sum(const Node& line, Session& session, JsonWriter& answer) {
  allow_only(line, {"id", "query", "a", "b", "epsilon", "representation", "side", "backend"});
  const double epsilon = read_epsilon(line);
  const Backend backend = read_backend(line);
  const Representation representation = read_representation(line);
  const Side side = read_side(line);
  for_dimension(composed_dimension(line.at("a"), session.limits), [&]<int D>() {
    const Stopwatch watch;
    const auto sum = with_fine_structures(epsilon, [&](double share) {
      const auto whole = ComposedBody<D>::sum_of(read_all<D>(line, session.limits, {share, backend}));
      if (!whole) line.refuse(whole.error());
      return dimension::approximate_minkowski_sum<D>(*whole, epsilon, representation, side);
    });
    if (!sum) line.refuse(sum.error());
    const std::int64_t nanoseconds = watch.nanoseconds();
    answer.key(representation == Representation::points ? "points" : "halfspaces").begin_array();
    for (const Vector<D>& p : sum->body.points) write_row<D>(p, answer);
    for (const dimension::Halfspace<D>& h : sum->body.halfspaces) write_halfspace<D>(h, answer);
    answer.end_array();
    answer.key("side").string(side == Side::outer ? "outer" : "inner");
    if (!sum->bracket_reached) write_reached(sum->epsilon, answer);
    answer.key("stats").begin_object();
    answer.key("support_calls").integer(sum->support_calls);
    answer.key("vertices").integer(sum->vertices).key("facets").integer(sum->facets);
    write_work(sum->counters, answer);
    answer.key("nanoseconds").integer(nanoseconds).end_object();
  });
}

}  // namespace pd::query
