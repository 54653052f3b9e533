#include "drawing/plane_curve.hpp"

#include <algorithm>
#include <cmath>

namespace pd::drawing {

namespace {

Point2 combined(const Point2& p, double s, const Point2& q, double t) {
  return {s * p[0] + t * q[0], s * p[1] + t * q[1]};
}

/// |a - 2 b + c|.
double second_difference(const Point2& a, const Point2& b, const Point2& c) {
  return std::hypot(a[0] - 2 * b[0] + c[0], a[1] - 2 * b[1] + c[1]);
}

/// The longest half axis of the ellipse u cos t + v sin t: the greatest singular value of (u v).
double longest_axis(const Point2& u, const Point2& v) {
  const double uu = u[0] * u[0] + u[1] * u[1], vv = v[0] * v[0] + v[1] * v[1], uv = u[0] * v[0] + u[1] * v[1];
  return std::sqrt(0.5 * (uu + vv) + std::hypot(0.5 * (uu - vv), uv));
}

/// Equal parts of the parameter that keep the chords within `distance`.
double parts_needed(const PlaneCurve& c, double distance) {
  switch (c.kind) {
    case PlaneCurve::Kind::line:
      return 1;
    case PlaneCurve::Kind::quadratic:
      return std::sqrt(2 * second_difference(c.from, c.control[0], c.to) / (8 * distance));
    case PlaneCurve::Kind::cubic: {
      const double most = std::max(second_difference(c.from, c.control[0], c.control[1]),
                                   second_difference(c.control[0], c.control[1], c.to));
      return std::sqrt(6 * most / (8 * distance));
    }
    case PlaneCurve::Kind::arc:
      break;
  }
  const double radius = longest_axis(c.control[0], c.control[1]);
  // 1 - cos(h / 2) = 2 sin(h / 4)^2; three parts of a turn at least, so that a circle stays an area.
  const double step = 4 * std::asin(std::sqrt(std::min(0.5, distance / (2 * radius))));
  return std::max(std::abs(c.sweep) / step, 3 * std::abs(c.sweep) / 6.28);
}

Point2 point_at(const PlaneCurve& c, double t) {
  const double s = 1 - t;
  switch (c.kind) {
    case PlaneCurve::Kind::line:
      return combined(c.from, s, c.to, t);
    case PlaneCurve::Kind::quadratic:
      return combined(combined(c.from, s * s, c.control[0], 2 * s * t), 1, c.to, t * t);
    case PlaneCurve::Kind::cubic:
      return combined(combined(c.from, s * s * s, c.control[0], 3 * s * s * t), 1,
                      combined(c.control[1], 3 * s * t * t, c.to, t * t * t), 1);
    case PlaneCurve::Kind::arc:
      break;
  }
  const double angle = c.start + t * c.sweep;
  return combined(c.centre, 1, combined(c.control[0], std::cos(angle), c.control[1], std::sin(angle)), 1);
}

}  // namespace

PlaneMap PlaneMap::after(const PlaneMap& inner) const {
  const Point2 x = vector({inner.a, inner.b}), y = vector({inner.c, inner.d}), o = point({inner.e, inner.f});
  return {x[0], x[1], y[0], y[1], o[0], o[1]};
}

PlaneCurve PlaneCurve::mapped(const PlaneMap& map) const {
  PlaneCurve r = *this;
  r.from = map.point(from);
  r.to = map.point(to);
  r.centre = map.point(centre);
  for (std::size_t k = 0; k < 2; ++k) {
    r.control[k] = kind == Kind::arc ? map.vector(control[k]) : map.point(control[k]);
  }
  return r;
}

void append_bounds(const PlaneCurve& curve, std::vector<Point2>& points) {
  points.push_back(curve.from);
  points.push_back(curve.to);
  if (curve.kind == PlaneCurve::Kind::quadratic) points.push_back(curve.control[0]);
  if (curve.kind == PlaneCurve::Kind::cubic) points.insert(points.end(), curve.control.begin(), curve.control.end());
  if (curve.kind != PlaneCurve::Kind::arc) return;
  for (const double s : {-1.0, 1.0}) {
    for (const double t : {-1.0, 1.0}) {
      points.push_back(combined(curve.centre, 1, combined(curve.control[0], s, curve.control[1], t), 1));
    }
  }
}

bool append_flattened(const PlaneCurve& curve, double distance, std::size_t most, std::vector<Point2>& points) {
  const double needed = std::ceil(parts_needed(curve, distance));
  if (!(needed <= static_cast<double>(most))) return false;
  const int parts = std::max(1, static_cast<int>(needed));
  for (int i = 1; i < parts; ++i) points.push_back(point_at(curve, static_cast<double>(i) / parts));
  points.push_back(curve.to);
  return true;
}

}  // namespace pd::drawing
