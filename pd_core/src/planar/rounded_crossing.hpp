/// @file
/// How far along a ray a line crosses it, rounded as the exact answer would be, in double-double with a bound of its
/// error: without big numbers wherever that settles every rounding.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <optional>

#include "numeric/double_double.hpp"
#include "planar/boundary/sum_geometry.hpp"

namespace pd::detail {

/// The next double away from 0 or towards it; x is finite and not 0.
inline double neighbour(double x, bool away_from_zero) {
  const auto bits = std::bit_cast<std::uint64_t>(x);
  return std::bit_cast<double>(away_from_zero ? bits + 1 : bits - 1);
}

/// a / b by two quotients: its relative error is below 15 u^2 + 56 u^3, u = 2^-53 (Joldes, Muller, Popescu 2017, their
/// algorithm 17).
inline DoubleDouble two_quotients(const DoubleDouble& a, const DoubleDouble& b) {
  const double q = a.hi / b.hi;
  const DoubleDouble rest = a - b * q;
  return quick_two_sum(q, rest.hi / b.hi);
}

/// The root by one correction of that of `hi`: what the correction is rounded by and what follows it in the series are
/// below 5 u^2 together. a > 0.
inline DoubleDouble corrected_root(const DoubleDouble& a) {
  const double s = std::sqrt(a.hi);
  const DoubleDouble rest = a - two_product(s, s);
  return quick_two_sum(s, rest.hi / (2 * s));
}

/// x y - z w with a bound of its absolute error, where x and z err by nothing and y and w by 3 u^2 of themselves, as a
/// sum of double-doubles does; products err by 5 u^2 and the difference by 3 u^2. Valid without over- or underflow.
struct BoundedCross {
  DoubleDouble value;
  double error;
  BoundedCross(const DoubleDouble& x, const DoubleDouble& y, const DoubleDouble& z, const DoubleDouble& w)
      : value(x * y - z * w), error(0x1p-101 * (std::abs(x.hi * y.hi) + std::abs(z.hi * w.hi))) {}
  BoundedCross(const DoubleDouble& x, double y, const DoubleDouble& z, double w)
      : value(x * y - z * w), error(0x1p-101 * (std::abs(x.hi * y) + std::abs(z.hi * w))) {}
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
  const double beyond = neighbour(value.hi, (value.lo > 0) == (value.hi > 0));
  return std::abs(value.lo) + relative * std::abs(value.hi) < 0.5 * std::abs(beyond - value.hi);
}

/// a + b + c to the nearest, ties to even; nothing where two doubles do not hold it.
inline std::optional<double> rounded_sum(double a, double b, double c) {
  const DoubleDouble ab = two_sum(a, b), high = two_sum(ab.hi, c), low = two_sum(ab.lo, high.lo);
  if (low.lo != 0) return std::nullopt;
  return high.hi + low.hi;
}

/// @param ray  its direction is given from the origin.
/// @return nothing where a rounding is in doubt (answers that are short numbers, for instance), or numbers are so large
/// or small that products of them might leave the range of doubles.
inline std::optional<RoundedCrossing> rounded_crossing(const Span& ray, const Point2& d, const Span& edge) {
  for (const Point2* x : {&ray.s.p, &d, &edge.s.p, &edge.s.q, &edge.d.from, &edge.d.to}) {
    for (const double c : *x) {
      if (c != 0 && !(std::abs(c) < 0x1p200 && std::abs(c) > 0x1p-200)) return std::nullopt;
    }
  }
  const auto edge_along = [&](std::size_t k) { return two_sum(edge.d.to[k], -edge.d.from[k]); };
  const auto from_ray = [&](std::size_t k) {
    return two_sum(edge.s.p[k], -ray.s.p[k]) - two_sum(edge.s.q[k], -ray.s.q[k]);
  };
  const DoubleDouble ex = edge_along(0), ey = edge_along(1);
  const Point2& ray_d = ray.d.to;
  const BoundedCross numerator(ex, from_ray(1), ey, from_ray(0)), denominator(ex, ray_d[1], ey, ray_d[0]);
  const double n = std::abs(numerator.value.hi), w = std::abs(denominator.value.hi);
  if (!(n > 0x1p20 * numerator.error && w > 0x1p20 * denominator.error)) return std::nullopt;
  // Quotients, a root, a sum of squares and two products: below 2^-97 beside the errors of the fraction.
  const double relative = (numerator.error / n + denominator.error / w) * 1.01 + 0x1p-97;
  const DoubleDouble t = two_quotients(numerator.value, denominator.value);
  if (!(t.hi > 0)) return std::nullopt;
  const DoubleDouble length = corrected_root(two_product(d[0], d[0]) + two_product(d[1], d[1]));
  const DoubleDouble depth = t * length, inverse = two_quotients({1, 0}, length);
  RoundedCrossing r{};
  if (!(std::abs(depth.lo) > relative * depth.hi) || !settles_nearest(depth, relative)) return std::nullopt;
  r.lower = depth.lo > 0 ? depth.hi : neighbour(depth.hi, false);
  r.upper = depth.lo > 0 ? neighbour(depth.hi, true) : depth.hi;
  for (std::size_t k = 0; k < 2; ++k) {
    if (edge.d.from[k] == edge.d.to[k]) {
      const std::optional<double> gap = rounded_sum(edge.s.p[k], -edge.s.q[k], -ray.s.p[k]);
      const DoubleDouble normal = inverse * d[k];
      if (!gap || !settles_nearest(normal, relative)) return std::nullopt;
      r.translation[k] = d[k] == 0 ? 0 : std::copysign(*gap, d[k]);  // the ray may be turned round
      r.normal[k] = normal.hi;
      continue;
    }
    const DoubleDouble move = t * d[k], normal = inverse * d[k];
    if (!settles_nearest(move, relative) || !settles_nearest(normal, relative)) return std::nullopt;
    r.translation[k] = move.hi;
    r.normal[k] = normal.hi;
  }
  return r;
}

}  // namespace pd::detail
