/// @file
/// How far along a ray a line crosses it, rounded as the exact answer would be, in double-double with a bound of its
/// error: without big numbers wherever that settles every rounding.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "numeric/double_double.hpp"
#include "planar/sum_geometry.hpp"

namespace pd::detail {

/// A double-double with a bound of its absolute error. Valid without over- or underflow.
struct BoundedDoubleDouble {
  DoubleDouble value;
  double error = 0;

  BoundedDoubleDouble() = default;
  BoundedDoubleDouble(double exact) : value{exact, 0} {}  // NOLINT(google-explicit-constructor): doubles are exact
  BoundedDoubleDouble(const DoubleDouble& v, double e) : value(v), error(e) {}

  /// Sums err by 3 u^2, products by 5 u^2 of their result (double_double.hpp), u = 2^-53.
  static constexpr double kRounding = 0x1p-102;
  friend BoundedDoubleDouble operator+(const BoundedDoubleDouble& a, const BoundedDoubleDouble& b) {
    const DoubleDouble v = a.value + b.value;
    return {v, (a.error + b.error + kRounding * std::abs(v.hi)) * (1 + 0x1p-40)};
  }
  friend BoundedDoubleDouble operator-(const BoundedDoubleDouble& a, const BoundedDoubleDouble& b) {
    return a + BoundedDoubleDouble(-b.value, b.error);
  }
  friend BoundedDoubleDouble operator*(const BoundedDoubleDouble& a, const BoundedDoubleDouble& b) {
    const DoubleDouble v = a.value * b.value;
    return {v, (std::abs(a.value.hi) * b.error + std::abs(b.value.hi) * a.error + a.error * b.error +
                kRounding * std::abs(v.hi)) *
                   (1 + 0x1p-40)};
  }
};

/// The crossing of a ray from y along d (or of both turned round, -d) at t > 0: t |d| between neighbouring doubles, t d
/// and d / |d| to the nearest.
struct RoundedCrossing {
  double lower, upper;
  Point2 translation, normal;
};

/// Is the nearest double of every number that `value` may be within the relative error the same one?
inline bool settles_nearest(const DoubleDouble& value, double relative) {
  if (value.hi == 0) return value.lo == 0;
  const double beyond = std::nextafter(
      value.hi, value.lo > 0 ? std::numeric_limits<double>::infinity() : -std::numeric_limits<double>::infinity());
  return std::abs(value.lo) + relative * std::abs(value.hi) < 0.5 * std::abs(beyond - value.hi);
}

/// a + b + c to the nearest, ties to even; nothing where two doubles do not hold it.
inline std::optional<double> rounded_sum(double a, double b, double c) {
  const DoubleDouble ab = two_sum(a, b), high = two_sum(ab.hi, c), low = two_sum(ab.lo, high.lo);
  if (low.lo != 0) return std::nullopt;
  return high.hi + low.hi;
}

/// @return nothing where a rounding is in doubt (answers that are short numbers, for instance), or numbers are so large
/// or small that products of them might leave the range of doubles.
inline std::optional<RoundedCrossing> rounded_crossing(const Span& ray, const Point2& d, const Span& edge) {
  for (const Point2* x : {&ray.s.p, &d, &edge.s.p, &edge.s.q, &edge.d.from, &edge.d.to}) {
    for (const double c : *x) {
      if (c != 0 && !(std::abs(c) < 0x1p200 && std::abs(c) > 0x1p-200)) return std::nullopt;
    }
  }
  const auto f = fraction<BoundedDoubleDouble>(ray, Place{Place::Kind::line, edge.s, edge.d});
  const double n = std::abs(f.numerator.value.hi), w = std::abs(f.denominator.value.hi);
  if (!(n > 0x1p20 * f.numerator.error && w > 0x1p20 * f.denominator.error)) return std::nullopt;
  // A quotient, a root, a sum of squares and two products: below 2^-97 beside the errors of the fraction.
  const double relative = (f.numerator.error / n + f.denominator.error / w) * 1.01 + 0x1p-97;
  const DoubleDouble t = f.numerator.value / f.denominator.value;
  if (!(t.hi > 0)) return std::nullopt;
  const DoubleDouble length = sqrt(two_product(d[0], d[0]) + two_product(d[1], d[1]));
  const DoubleDouble depth = t * length;
  RoundedCrossing r{};
  if (!(std::abs(depth.lo) > relative * depth.hi) || !settles_nearest(depth, relative)) return std::nullopt;
  r.lower = depth.lo > 0 ? depth.hi : std::nextafter(depth.hi, 0.0);
  r.upper = depth.lo > 0 ? std::nextafter(depth.hi, std::numeric_limits<double>::infinity()) : depth.hi;
  for (std::size_t k = 0; k < 2; ++k) {
    if (edge.d.from[k] == edge.d.to[k]) {
      const std::optional<double> gap = rounded_sum(edge.s.p[k], -edge.s.q[k], -ray.s.p[k]);
      const DoubleDouble normal = DoubleDouble{d[k], 0} / length;
      if (!gap || !settles_nearest(normal, relative)) return std::nullopt;
      r.translation[k] = d[k] == 0 ? 0 : std::copysign(*gap, d[k]);  // the ray may be turned round
      r.normal[k] = normal.hi;
      continue;
    }
    const DoubleDouble move = t * d[k], normal = DoubleDouble{d[k], 0} / length;
    if (!settles_nearest(move, relative) || !settles_nearest(normal, relative)) return std::nullopt;
    r.translation[k] = move.hi;
    r.normal[k] = normal.hi;
  }
  return r;
}

}  // namespace pd::detail
