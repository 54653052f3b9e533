/// @file
/// Double-double arithmetic: an unevaluated sum hi + lo with |lo| <= ulp(hi)/2, about 106 bits.
///
/// Shewchuk, "Adaptive precision floating-point arithmetic and fast robust geometric predicates", 1997 (two-sum,
/// two-product); Joldes, Muller, Popescu, "Tight and rigorous error bounds for basic building blocks of double-word
/// arithmetic", 2017 (the relative errors: sum of any signs 3u^2 + O(u^3) with the accurate algorithm, product 5u^2;
/// u = 2^-53). No fused multiply-add here: the bits must be those of every machine (kernels in lanes may take one
/// where it gives the same bits, fused_products.hpp). Valid without over- or underflow.
#pragma once

#include <cmath>

namespace pd::detail {

struct DoubleDouble {
  double hi = 0;
  double lo = 0;
};

/// Relative error unit of double-double operations, each of which errs by less than 5u^2 < 2 kUdd.
inline constexpr double kUdd = 0x1p-104;

/// a + b exactly.
inline DoubleDouble two_sum(double a, double b) {
  const double s = a + b;
  const double bb = s - a;
  return {s, (a - (s - bb)) + (b - bb)};
}
/// a + b exactly when |a| >= |b| or a == 0.
inline DoubleDouble quick_two_sum(double a, double b) {
  const double s = a + b;
  return {s, b - (s - a)};
}
/// Veltkamp's split into two 26-bit halves.
inline DoubleDouble split(double a) {
  const double c = 134217729.0 * a;  // 2^27 + 1
  const double hi = c - (c - a);
  return {hi, a - hi};
}
/// a * b exactly (Dekker).
inline DoubleDouble two_product(double a, double b) {
  const double p = a * b;
  const DoubleDouble x = split(a);
  const DoubleDouble y = split(b);
  return {p, ((x.hi * y.hi - p) + x.hi * y.lo + x.lo * y.hi) + x.lo * y.lo};
}

inline DoubleDouble operator-(const DoubleDouble& a) { return {-a.hi, -a.lo}; }
inline DoubleDouble operator+(const DoubleDouble& a, const DoubleDouble& b) {
  DoubleDouble s = two_sum(a.hi, b.hi);
  const DoubleDouble t = two_sum(a.lo, b.lo);
  s = quick_two_sum(s.hi, s.lo + t.hi);
  return quick_two_sum(s.hi, s.lo + t.lo);
}
inline DoubleDouble operator-(const DoubleDouble& a, const DoubleDouble& b) { return a + (-b); }
/// a - b with the same bits, where b is a up to rounding: the difference of the high parts is exact (Sterbenz), so that
/// their two-sum, the first link of a chain, is one operation.
inline DoubleDouble difference_of_near(const DoubleDouble& a, const DoubleDouble& b) {
  const DoubleDouble t = two_sum(a.lo, -b.lo);
  const DoubleDouble s = quick_two_sum(a.hi - b.hi, t.hi);
  return quick_two_sum(s.hi, s.lo + t.lo);
}
inline DoubleDouble operator*(const DoubleDouble& a, const DoubleDouble& b) {
  const DoubleDouble p = two_product(a.hi, b.hi);
  return quick_two_sum(p.hi, p.lo + (a.hi * b.lo + a.lo * b.hi));
}
inline DoubleDouble operator*(const DoubleDouble& a, double b) {
  const DoubleDouble p = two_product(a.hi, b);
  return quick_two_sum(p.hi, p.lo + a.lo * b);
}
inline DoubleDouble operator/(const DoubleDouble& a, const DoubleDouble& b) {
  const double q1 = a.hi / b.hi;
  DoubleDouble r = a - b * q1;
  const double q2 = r.hi / b.hi;
  r = r - b * q2;
  const double q3 = r.hi / b.hi;
  return quick_two_sum(q1, q2) + DoubleDouble{q3, 0};
}
/// Square root, relative error a few u^2; 0 for 0. Requires a >= 0.
inline DoubleDouble sqrt(const DoubleDouble& a) {
  if (a.hi <= 0) return {0, 0};
  const double s = std::sqrt(a.hi);
  const DoubleDouble r = a - two_product(s, s);
  const DoubleDouble t = quick_two_sum(s, r.hi / (2 * s));
  const DoubleDouble r2 = a - t * t;
  return t + DoubleDouble{r2.hi / (2 * s), 0};
}
inline double to_double(const DoubleDouble& a) { return a.hi + a.lo; }

/// Three of them.
struct Vec3DD {
  DoubleDouble x, y, z;
};
inline Vec3DD operator-(const Vec3DD& a, const Vec3DD& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vec3DD operator+(const Vec3DD& a, const Vec3DD& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline DoubleDouble dot(const Vec3DD& a, const Vec3DD& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec3DD cross(const Vec3DD& a, const Vec3DD& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline Vec3DD scaled(const Vec3DD& v, const DoubleDouble& s) { return {v.x * s, v.y * s, v.z * s}; }
/// The sum of the leading digits, absolute.
inline double norm1(const Vec3DD& v) { return std::abs(v.x.hi) + std::abs(v.y.hi) + std::abs(v.z.hi); }

}  // namespace pd::detail
