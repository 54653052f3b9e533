#include "pd/planar/polygon_depth.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <string>

#include "numeric/quotient.hpp"
#include "planar/boundary/seats.hpp"
#include "planar/difference_state.hpp"
#include "planar/polygon_answer.hpp"
#include "planar/straight_escape.hpp"

namespace pd {

using detail::BoundaryPoint;
using detail::Dyadic;
using detail::Place;

std::string_view to_string(PlanarContact contact) {
  switch (contact) {
    case PlanarContact::overlapping:
      return "overlapping";
    case PlanarContact::touching:
      return "touching";
    case PlanarContact::separated:
      return "separated";
  }
  return "";
}

Expected<PolygonDifference> PolygonDifference::of(const Polygon& p, const Polygon& q, PolygonMethod method,
                                                  std::int64_t max_comparisons) {
  const bool one_convex = p.convex() || q.convex();
  if (method == PolygonMethod::implicit && !one_convex) {
    return Error{ErrorCode::unsupported,
                 "the implicit method needs a convex polygon; both have reflex corners or holes", "method"};
  }
  const bool point = p.is_point() || q.is_point();
  if (point && method == PolygonMethod::explicit_sums) {
    return Error{ErrorCode::unsupported, "explicit sums need two polygons of an area; one is a point", "method"};
  }
  const bool implicit = one_convex && method != PolygonMethod::explicit_sums;
  const bool swapped = implicit && (!q.convex() || (p.is_point() && !q.is_point()));
  PolygonDifference r;
  r.state_ = swapped ? std::make_shared<const State>(q, p, implicit, true, max_comparisons)
                     : std::make_shared<const State>(p, q, implicit, false, max_comparisons);
  // The implicit form relies on Facts 4.1 and 4.2: where they were seen to fail, it is given up.
  if (implicit && !r.state_->boundary.counts().facts_hold()) {
    auto rebuilt = std::make_shared<State>(p, q, false, false, max_comparisons);
    rebuilt->given_up = r.state_->boundary.counts();
    r.state_ = std::move(rebuilt);
  }
  if (!r.state_->boundary.complete()) {
    return Error{ErrorCode::limit_exceeded,
                 "the sums of convex parts took more than " + std::to_string(max_comparisons) +
                     " comparisons: fewer vertices or one convex polygon take fewer, max_comparisons allows more",
                 "max_comparisons"};
  }
  return r;
}

void PolygonDifference::State::move_to_nearest(const Point2& y, bool outer_only, PolygonDepth& answer) const {
  const auto nearest = query.nearest(y, outer_only);
  assert(nearest);
  detail::fill(answer, detail::difference(detail::point_at<Dyadic>(query.span_of(*nearest), nearest->at), y), swapped);
  answer.feature = detail::feature_of(boundary, p, q, *nearest, swapped);
}

PlanarContact PolygonDifference::contact(const Point2& placement) const {
  return state_->query.contact(state_->turned(placement));
}

PolygonDepth PolygonDifference::depth(const Point2& placement) const {
  const State& s = *state_;
  const Point2 y = s.turned(placement);
  PolygonDepth answer;
  std::optional<BoundaryPoint> touched;
  answer.contact = s.query.contact(y, &touched);
  if (answer.contact == PlanarContact::touching) {
    detail::fill_touching(answer, s.query.span_of(*touched), s.swapped);
    answer.feature = detail::feature_of(s.boundary, s.p, s.q, *touched, s.swapped);
  }
  if (answer.contact != PlanarContact::overlapping) return answer;
  s.move_to_nearest(y, false, answer);
  return answer;
}

PolygonDepth PolygonDifference::escape_depth(const Point2& placement) const {
  const State& s = *state_;
  const Point2 y = s.turned(placement);
  PolygonDepth answer;
  answer.contact = s.query.contact(y);
  if (answer.contact != PlanarContact::overlapping && s.query.in_unbounded_face(y)) return answer;
  s.move_to_nearest(y, true, answer);
  return answer;
}

PolygonDepth PolygonDifference::straight_escape_depth(const Point2& placement) const {
  const State& s = *state_;
  const Point2 y = s.turned(placement);
  PolygonDepth answer;
  answer.contact = s.query.contact(y);
  if (s.boundary.stretches().empty()) return answer;
  const detail::StraightEscape::Way way = detail::StraightEscape(s.boundary, s.query, y).run();
  if (!way.exit) return answer;
  detail::fill(answer, way.move, s.swapped);
  answer.feature = detail::feature_of(s.boundary, s.p, s.q, *way.exit, s.swapped);
  return answer;
}

PolygonDepth PolygonDifference::depth_along(const Point2& placement, const Point2& given, Leave leave,
                                            std::int64_t* boxes) const {
  const State& s = *state_;
  const Point2 direction = detail::raised(given);
  const Point2 y = s.turned(placement), d = s.turned(direction);
  PolygonDepth answer;
  std::optional<BoundaryPoint> touched, first;
  answer.contact = s.query.contact_and_hit(y, d, touched, first, boxes);
  const detail::Span ray{detail::BoundaryQuery::point(y), {{0, 0}, d}, {}};
  if (leave == Leave::straight) {
    if (const auto out = s.query.last_exit(y, d)) {
      if (out->kind == Place::Kind::line) {
        detail::fill_hit(answer, ray, direction, {out->point, out->direction, {}}, {Place::Kind::line, ray.s, ray.d},
                         s.swapped);
      } else {
        detail::fill(answer, detail::difference(detail::point_at<Dyadic>(ray, *out), y), s.swapped);
      }
    }
    return answer;
  }
  if (answer.contact != PlanarContact::overlapping) {
    if (touched) {
      detail::fill_touching(answer, s.query.span_of(*touched), s.swapped);
      answer.feature = detail::feature_of(s.boundary, s.p, s.q, *touched, s.swapped);
    }
    if (leave == Leave::first_exit || s.query.in_unbounded_face(y)) return answer;
  }
  const auto hit = leave == Leave::escape ? s.query.first_on_ray(y, d, true) : first;
  assert(hit);
  detail::fill_hit(answer, ray, direction, s.query.span_of(*hit), hit->at, s.swapped);
  answer.feature = detail::feature_of(s.boundary, s.p, s.q, *hit, s.swapped);
  return answer;
}

PolygonDifference::Statistics PolygonDifference::statistics() const {
  const detail::SumBoundary& b = state_->boundary;
  std::int64_t arcs = 0;
  for (const detail::Stretch& stretch : b.stretches()) {
    arcs += b.candidate(stretch).id % 2 == 1 && state_->implicit ? 1 : 0;
  }
  const auto& c = b.counts();
  const auto& facts = state_->given_up.value_or(c);
  return {.sums = c.sums,
          .stretches = static_cast<std::int64_t>(b.stretches().size()),
          .arcs = arcs,
          .reflex_points = facts.reflex_points,
          .reflex_bound = facts.reflex_bound(),
          .crossings = facts.crossings,
          .most_crossings = facts.most_crossings,
          .loops = b.num_loops(),
          .pairs = c.pairs,
          .locations = c.locations,
          .memory_bytes = static_cast<std::int64_t>(b.memory_bytes() + state_->query.memory_bytes()),
          .implicit = state_->implicit,
          .facts_hold = !state_->given_up};
}

namespace {

Point2 rounded_point(const detail::Span& span, const Place& at, double sign) {
  const auto x = detail::point_at<Dyadic>(span, at);
  return {sign * detail::quotient(x.x, x.w), sign * detail::quotient(x.y, x.w)};
}

}  // namespace

std::vector<PolygonDifference::Curve> PolygonDifference::boundary_curves() const {
  const detail::SumBoundary& b = state_->boundary;
  const double sign = state_->swapped ? -1 : 1;
  std::vector<Curve> curves;
  for (const detail::Stretch& s : b.stretches()) {
    Curve curve{s.loop, state_->implicit && b.candidate(s).id % 2 == 1, {}};
    for (int e = detail::SumBoundary::first_edge(s); e <= detail::SumBoundary::last_edge(s); ++e) {
      const detail::EdgePart part = b.part(s, e);
      if (curve.points.empty()) curve.points.push_back(rounded_point(part.span, part.from, sign));
      curve.points.push_back(rounded_point(part.span, part.to, sign));
    }
    curves.push_back(std::move(curve));
  }
  return curves;
}

bool PolygonDifference::seat(const Point2& placement) const {
  const detail::BoundaryQuery& query = state_->query;
  const Point2 y = state_->turned(placement);
  return query.contact(y) == PlanarContact::overlapping && query.is_seat(y);
}

PolygonDifference::Seats PolygonDifference::seats() const {
  const State& s = *state_;
  // The budget was kept by the boundary at hand, whose steps are repeated.
  const detail::SumBoundary boundary(s.p, s.q, s.implicit, std::numeric_limits<std::int64_t>::max(), true);
  Seats seats{detail::single_seats(detail::BoundaryQuery(boundary)), detail::whole_slots(boundary)};
  if (!s.swapped) return seats;
  const auto turned = [](Point2& x) { x = {0 - x[0], 0 - x[1]}; };
  for (Point2& x : seats.points) turned(x);
  for (auto& slot : seats.slots) {
    turned(slot[0]);
    turned(slot[1]);
    std::swap(slot[0], slot[1]);
  }
  std::sort(seats.points.begin(), seats.points.end());
  return seats;
}

}  // namespace pd
