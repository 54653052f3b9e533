/// @file
/// Points, lines and places of R = P + (-Q), kept as what they are made of, so that every sign is that of the stored
/// numbers.
///
/// A vertex of a convex sum is p - q; an edge's direction is a difference of two vertices of one polygon; a place on an
/// edge is a fraction along it. Nothing here is rounded before its sign is taken.
#pragma once

#include <array>

#include "numeric/estimate.hpp"
#include "pd/planar/polygon.hpp"

namespace pd::detail {

/// The point p - q.
struct SumPoint {
  Point2 p;
  Point2 q;
};

/// The direction to - from.
struct PlaneDirection {
  Point2 from;
  Point2 to;
  [[nodiscard]] PlaneDirection reversed() const { return {to, from}; }
};

template <class N>
struct Vector2 {
  N x, y;
};
template <class N>
N cross(const Vector2<N>& a, const Vector2<N>& b) {
  return a.x * b.y - a.y * b.x;
}
template <class N>
N dot(const Vector2<N>& a, const Vector2<N>& b) {
  return a.x * b.x + a.y * b.y;
}
template <class N>
Vector2<N> vector(const PlaneDirection& d) {
  return {N(d.to[0]) - N(d.from[0]), N(d.to[1]) - N(d.from[1])};
}
/// b - a.
template <class N>
Vector2<N> from_to(const SumPoint& a, const SumPoint& b) {
  return {(N(b.p[0]) - N(a.p[0])) - (N(b.q[0]) - N(a.q[0])), (N(b.p[1]) - N(a.p[1])) - (N(b.q[1]) - N(a.q[1]))};
}

inline bool same(const SumPoint& a, const SumPoint& b) {
  if (a.p == b.p && a.q == b.q) return true;
  for (std::size_t k = 0; k < 2; ++k) {
    if (exact_sign([&]<class N>() { return (N(b.p[k]) - N(a.p[k])) - (N(b.q[k]) - N(a.q[k])); }) != 0) return false;
  }
  return true;
}

inline int cross_sign(const PlaneDirection& a, const PlaneDirection& b) {
  return exact_sign([&]<class N>() { return cross(vector<N>(a), vector<N>(b)); });
}
/// 1 where x lies on the left of the line through s along d, 0 on it.
inline int side_of(const SumPoint& s, const PlaneDirection& d, const SumPoint& x) {
  return exact_sign([&]<class N>() { return cross(vector<N>(d), from_to<N>(s, x)); });
}

/// 0 for directions turned by an angle in (-90, 90] degrees from the x axis, 1 for the others.
inline int half_of(const PlaneDirection& d) {
  if (d.to[0] != d.from[0]) return d.to[0] > d.from[0] ? 0 : 1;
  return d.to[1] > d.from[1] ? 0 : 1;
}
/// Order of directions by their angle in (-90, 270] degrees: -1, 0, 1.
inline int compare_angles(const PlaneDirection& a, const PlaneDirection& b) {
  const int ha = half_of(a), hb = half_of(b);
  if (ha != hb) return ha < hb ? -1 : 1;
  return -cross_sign(a, b);
}

/// A straight piece: from s on along d, as far as z (on the line, ahead of s).
struct Span {
  SumPoint s;
  PlaneDirection d;
  SumPoint z;
};

/// Where on a span: at its start, at its end, at a point of its line, or where another line crosses it.
struct Place {
  enum class Kind : std::uint8_t { start, end, point, line } kind = Kind::start;
  SumPoint point = {};
  PlaneDirection direction = {};  ///< of the crossing line through `point`
};

template <class N>
struct Fraction {
  N numerator, denominator;
};

/// The place x as s + fraction * d.
template <class N>
Fraction<N> fraction(const Span& e, const Place& x) {
  const Vector2<N> d = vector<N>(e.d);
  switch (x.kind) {
    case Place::Kind::start:
      return {N(0.0), N(1.0)};
    case Place::Kind::end:
      return {dot(from_to<N>(e.s, e.z), d), dot(d, d)};
    case Place::Kind::point:
      return {dot(from_to<N>(e.s, x.point), d), dot(d, d)};
    case Place::Kind::line:
      break;
  }
  const Vector2<N> other = vector<N>(x.direction);
  return {cross(other, from_to<N>(e.s, x.point)), cross(other, d)};
}

/// Order of two places along a span: -1, 0, 1.
inline int compare_places(const Span& e, const Place& a, const Place& b) {
  if (a.kind == b.kind && (a.kind == Place::Kind::start || a.kind == Place::Kind::end)) return 0;
  const auto evaluate = [&]<class N>() {
    const Fraction<N> f = fraction<N>(e, a), g = fraction<N>(e, b);
    return std::array<N, 3>{f.numerator * g.denominator - g.numerator * f.denominator, f.denominator, g.denominator};
  };
  const auto estimate = evaluate.template operator()<Estimate>();
  const int sign = estimate[0].certain_sign() * estimate[1].certain_sign() * estimate[2].certain_sign();
  if (sign != 0 || estimate[0].is_zero()) return sign;
  const auto exact = evaluate.template operator()<Dyadic>();
  return exact[0].sign() * exact[1].sign() * exact[2].sign();
}

/// A point of the plane as (x / w, y / w), w != 0.
template <class N>
struct Homogeneous {
  N x, y, w;
};
template <class N>
Homogeneous<N> point_at(const Span& e, const Place& at) {
  const Vector2<N> s = {N(e.s.p[0]) - N(e.s.q[0]), N(e.s.p[1]) - N(e.s.q[1])};
  if (at.kind == Place::Kind::start) return {s.x, s.y, N(1.0)};
  if (at.kind == Place::Kind::end) return {N(e.z.p[0]) - N(e.z.q[0]), N(e.z.p[1]) - N(e.z.q[1]), N(1.0)};
  const Fraction<N> f = fraction<N>(e, at);
  const Vector2<N> d = vector<N>(e.d);
  return {s.x * f.denominator + d.x * f.numerator, s.y * f.denominator + d.y * f.numerator, f.denominator};
}

}  // namespace pd::detail
