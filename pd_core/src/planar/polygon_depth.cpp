#include "pd/planar/polygon_depth.hpp"

#include <bit>
#include <cassert>
#include <cmath>

#include "numeric/root_sum.hpp"
#include "planar/boundary_query.hpp"
#include "planar/rounded_crossing.hpp"

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

/// Where only Q is non-convex the implicit method takes the two in each other's place: Q + (-P) is -R.
struct PolygonDifference::State {
  State(const Polygon& p_in, const Polygon& q_in, bool implicit_in, bool swapped_in)
      : p(p_in), q(q_in), implicit(implicit_in), swapped(swapped_in), boundary(p, q, implicit), query(boundary) {}

  Polygon p, q;
  bool implicit, swapped;
  std::optional<detail::BoundaryCounts> given_up;  ///< of an implicit boundary that contradicted Facts 4.1 or 4.2
  detail::SumBoundary boundary;
  detail::BoundaryQuery query;

  [[nodiscard]] Point2 turned(const Point2& v) const { return swapped ? Point2{-v[0], -v[1]} : v; }
};

namespace {

/// The nearest double, ties to even.
double rounded(const Dyadic& numerator, const Dyadic& denominator) {
  // The exponents of both may pass the range of doubles: bring the denominator near 1.
  const int shift =
      -(denominator.exponent() + static_cast<int>(msb(boost::multiprecision::abs(denominator.mantissa()))));
  const Dyadic n = numerator.scaled(shift), w = denominator.scaled(shift);
  const detail::DoubleDouble q = detail::to_double_double(n) / detail::to_double_double(w);
  const double near = detail::to_double(q);
  if (near == 0 || detail::settles_nearest(q, 0x1p-96)) return near;
  const double other = std::nextafter(near, q.lo > 0 ? HUGE_VAL : -HUGE_VAL);
  const Dyadic beyond = n - (Dyadic(near) + Dyadic(other)).scaled(-1) * w;  // the middle of the two
  const int side = beyond.sign() * w.sign() * (other > near ? 1 : -1);
  if (side == 0) return (std::bit_cast<std::uint64_t>(near) & 1U) == 0 ? near : other;
  return side > 0 ? other : near;
}

Point2 unit(const Dyadic& x, const Dyadic& y) {
  const detail::Vec3DD u = detail::unit_double_double({x, y, Dyadic()});
  return {detail::to_double(u.x), detail::to_double(u.y)};
}

/// An exact vector (x / w, y / w).
struct ExactVector {
  Dyadic x, y, w;
};

void fill(PolygonDepth& answer, const ExactVector& v, bool turned) {
  Dyadic x = v.x, y = v.y, w = v.w;
  if ((w.sign() < 0) != turned) {
    x = -x;
    y = -y;
  }
  if (w.sign() < 0) w = -w;
  const Dyadic squared = x * x + y * y;
  if (squared.sign() == 0) return;
  const detail::RootSum length(Dyadic(), 1, squared, w * w);
  answer.lower = length.round_down();
  answer.upper = length.round_up(answer.lower);
  answer.depth = answer.upper;
  answer.translation = {rounded(x, w), rounded(y, w)};
  answer.normal = unit(x, y);
}

/// Of Q where it touches P along that edge of the boundary: the edge's outer normal.
void fill_touching(PolygonDepth& answer, const detail::Span& edge, bool turned) {
  const auto d = detail::vector<Dyadic>(edge.d);
  answer.normal = turned ? unit(-d.y, d.x) : unit(d.y, -d.x);
}

ExactVector difference(const detail::Homogeneous<Dyadic>& x, const Point2& y) {
  return {x.x - Dyadic(y[0]) * x.w, x.y - Dyadic(y[1]) * x.w, x.w};
}

/// Of Q moved along the ray as far as a place on that edge.
void fill_hit(PolygonDepth& answer, const detail::Span& ray, const Point2& direction, const detail::Span& edge,
              const Place& at, bool turned) {
  if (at.kind == Place::Kind::line) {
    if (const auto r = detail::rounded_crossing(ray, direction, edge)) {
      answer.lower = r->lower;
      answer.depth = answer.upper = r->upper;
      answer.translation = r->translation;
      answer.normal = r->normal;
      return;
    }
  }
  fill(answer, difference(detail::point_at<Dyadic>(edge, at), ray.s.p), turned);
}

std::optional<PlanarFeature> feature_of(const detail::SumBoundary& boundary, const Polygon& p, const Polygon& q,
                                        const BoundaryPoint& x, bool swapped) {
  const auto c = boundary.contact(boundary.stretches()[static_cast<std::size_t>(x.stretch)], x.edge);
  PlanarFeature f{c.p_edge ? p.caller_edge(c.p) : p.caller_id(c.p), c.q_edge ? q.caller_edge(c.q) : q.caller_id(c.q),
                  c.p_edge, c.q_edge};
  if (swapped) {
    std::swap(f.p, f.q);
    std::swap(f.p_edge, f.q_edge);
  }
  return f;
}

}  // namespace

Expected<PolygonDifference> PolygonDifference::of(const Polygon& p, const Polygon& q, PolygonMethod method) {
  const bool one_convex = p.convex() || q.convex();
  if (method == PolygonMethod::implicit && !one_convex) {
    return Error{ErrorCode::unsupported,
                 "the implicit method needs a convex polygon; both have reflex corners or holes", "method"};
  }
  const bool implicit = one_convex && method != PolygonMethod::explicit_sums;
  const bool swapped = implicit && !q.convex();
  PolygonDifference r;
  r.state_ = swapped ? std::make_shared<const State>(q, p, implicit, true)
                     : std::make_shared<const State>(p, q, implicit, false);
  // The implicit form relies on Facts 4.1 and 4.2: where they were seen to fail, it is given up.
  if (implicit && !r.state_->boundary.counts().facts_hold()) {
    auto rebuilt = std::make_shared<State>(p, q, false, false);
    rebuilt->given_up = r.state_->boundary.counts();
    r.state_ = std::move(rebuilt);
  }
  return r;
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
    fill_touching(answer, s.query.span_of(*touched), s.swapped);
    answer.feature = feature_of(s.boundary, s.p, s.q, *touched, s.swapped);
  }
  if (answer.contact != PlanarContact::overlapping) return answer;
  const auto nearest = s.query.nearest(y, false);
  assert(nearest);
  fill(answer, difference(detail::point_at<Dyadic>(s.query.span_of(*nearest), nearest->at), y), s.swapped);
  answer.feature = feature_of(s.boundary, s.p, s.q, *nearest, s.swapped);
  return answer;
}

PolygonDepth PolygonDifference::escape_depth(const Point2& placement) const {
  const State& s = *state_;
  const Point2 y = s.turned(placement);
  PolygonDepth answer;
  answer.contact = s.query.contact(y);
  if (answer.contact != PlanarContact::overlapping && s.query.in_unbounded_face(y)) return answer;
  const auto nearest = s.query.nearest(y, true);
  assert(nearest);
  fill(answer, difference(detail::point_at<Dyadic>(s.query.span_of(*nearest), nearest->at), y), s.swapped);
  answer.feature = feature_of(s.boundary, s.p, s.q, *nearest, s.swapped);
  return answer;
}

PolygonDepth PolygonDifference::depth_along(const Point2& placement, const Point2& direction, Leave leave) const {
  const State& s = *state_;
  const Point2 y = s.turned(placement), d = s.turned(direction);
  PolygonDepth answer;
  std::optional<BoundaryPoint> touched, first;
  answer.contact = s.query.contact_and_hit(y, d, touched, first);
  const detail::Span ray{detail::BoundaryQuery::point(y), {{0, 0}, d}, {}};
  if (leave == Leave::straight) {
    if (const auto out = s.query.last_exit(y, d)) {
      fill(answer, difference(detail::point_at<Dyadic>(ray, *out), y), s.swapped);
    }
    return answer;
  }
  if (answer.contact != PlanarContact::overlapping) {
    if (touched) {
      fill_touching(answer, s.query.span_of(*touched), s.swapped);
      answer.feature = feature_of(s.boundary, s.p, s.q, *touched, s.swapped);
    }
    if (leave == Leave::first_exit || s.query.in_unbounded_face(y)) return answer;
  }
  const auto hit = leave == Leave::escape ? s.query.first_on_ray(y, d, true) : first;
  assert(hit);
  fill_hit(answer, ray, direction, s.query.span_of(*hit), hit->at, s.swapped);
  answer.feature = feature_of(s.boundary, s.p, s.q, *hit, s.swapped);
  return answer;
}

PolygonDifference::Statistics PolygonDifference::statistics() const {
  const detail::SumBoundary& b = state_->boundary;
  std::int64_t arcs = 0;
  for (const detail::Stretch& stretch : b.stretches())
    arcs += b.candidate(stretch).id % 2 == 1 && state_->implicit ? 1 : 0;
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
  return {sign * rounded(x.x, x.w), sign * rounded(x.y, x.w)};
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

std::vector<std::array<Point2, 2>> PolygonDifference::slots() const {
  const detail::SumBoundary& b = state_->boundary;
  const double sign = state_->swapped ? -1 : 1;
  std::vector<std::array<Point2, 2>> slots;
  for (const detail::Stretch& s : b.slots()) {
    for (int e = detail::SumBoundary::first_edge(s); e <= detail::SumBoundary::last_edge(s); ++e) {
      const detail::EdgePart part = b.part(s, e);
      slots.push_back({rounded_point(part.span, part.from, sign), rounded_point(part.span, part.to, sign)});
    }
  }
  return slots;
}

}  // namespace pd
