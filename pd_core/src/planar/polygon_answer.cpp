#include "planar/polygon_answer.hpp"

#include <bit>
#include <cmath>

#include "numeric/root_sum.hpp"
#include "planar/rounded_crossing.hpp"

namespace pd::detail {

namespace {

/// The nearest double, ties to even.
double rounded(const Dyadic& numerator, const Dyadic& denominator) {
  // The exponents of both may pass the range of doubles: bring the denominator near 1.
  const int shift =
      -(denominator.exponent() + static_cast<int>(msb(boost::multiprecision::abs(denominator.mantissa()))));
  const Dyadic n = numerator.scaled(shift), w = denominator.scaled(shift);
  const DoubleDouble q = to_double_double(n) / to_double_double(w);
  const double near = to_double(q);
  if (near == 0 || settles_nearest(q, 0x1p-96)) return near;
  const double other = std::nextafter(near, q.lo > 0 ? HUGE_VAL : -HUGE_VAL);
  const Dyadic beyond = n - (Dyadic(near) + Dyadic(other)).scaled(-1) * w;  // the middle of the two
  const int side = beyond.sign() * w.sign() * (other > near ? 1 : -1);
  if (side == 0) return (std::bit_cast<std::uint64_t>(near) & 1U) == 0 ? near : other;
  return side > 0 ? other : near;
}

Point2 unit(const Dyadic& x, const Dyadic& y) {
  const Vec3DD u = unit_double_double({x, y, Dyadic()});
  return {to_double(u.x), to_double(u.y)};
}

}  // namespace

void fill(PolygonDepth& answer, const ExactVector& v, bool turned) {
  Dyadic x = v.x, y = v.y, w = v.w;
  if ((w.sign() < 0) != turned) {
    x = -x;
    y = -y;
  }
  if (w.sign() < 0) w = -w;
  const Dyadic squared = x * x + y * y;
  if (squared.sign() == 0) return;
  const RootSum length(Dyadic(), 1, squared, w * w);
  answer.lower = length.round_down();
  answer.upper = length.round_up(answer.lower);
  answer.depth = answer.upper;
  answer.translation = {rounded(x, w), rounded(y, w)};
  answer.normal = unit(x, y);
}

void fill_touching(PolygonDepth& answer, const Span& edge, bool turned) {
  const auto d = vector<Dyadic>(edge.d);
  answer.normal = turned ? unit(-d.y, d.x) : unit(d.y, -d.x);
}

ExactVector difference(const Homogeneous<Dyadic>& x, const Point2& y) {
  return {x.x - Dyadic(y[0]) * x.w, x.y - Dyadic(y[1]) * x.w, x.w};
}

void fill_hit(PolygonDepth& answer, const Span& ray, const Point2& direction, const Span& edge, const Place& at,
              bool turned) {
  if (at.kind == Place::Kind::line) {
    if (const auto r = rounded_crossing(ray, direction, edge)) {
      answer.lower = r->lower;
      answer.depth = answer.upper = r->upper;
      answer.translation = r->translation;
      answer.normal = r->normal;
      return;
    }
  }
  fill(answer, difference(point_at<Dyadic>(edge, at), ray.s.p), turned);
}

std::optional<PlanarFeature> feature_of(const SumBoundary& boundary, const Polygon& p, const Polygon& q,
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

}  // namespace pd::detail
