/// @file
/// Integers of any length, and the exact passage between them and doubles: the arithmetic of the oracle.
///
/// The oracle shares no code with the library that it judges; this is its own, and it is plain on purpose: every number
/// of a pair is brought to one power of two and becomes an integer.
#pragma once

#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <cstdint>

#include "pd/numeric/vector.hpp"

namespace pd::oracle {

/// Any length; about 1000 bits are kept in place, so that most pairs never reach the allocator.
using Integer = boost::multiprecision::number<
    boost::multiprecision::cpp_int_backend<1024, 0, boost::multiprecision::signed_magnitude,
                                           boost::multiprecision::unchecked>,
    boost::multiprecision::et_off>;

/// mantissa * 2^exponent.
struct Scaled {
  Integer mantissa = 0;
  int exponent = 0;
};

/// Exact for every finite double; the mantissa is odd (or 0, with exponent 0).
inline Scaled to_scaled(double value) {
  if (value == 0) return {};
  int exponent = 0;
  auto mantissa = static_cast<std::int64_t>(std::ldexp(std::frexp(value, &exponent), 53));
  exponent -= 53;
  while ((mantissa & 1) == 0) {
    mantissa /= 2;
    ++exponent;
  }
  return {Integer(mantissa), exponent};
}

inline Integer shifted(const Integer& value, int left) { return left > 0 ? Integer(value << left) : value; }

inline Scaled operator*(const Scaled& a, const Scaled& b) { return {a.mantissa * b.mantissa, a.exponent + b.exponent}; }
inline Scaled operator+(const Scaled& a, const Scaled& b) {
  if (a.mantissa.is_zero()) return b;
  if (b.mantissa.is_zero()) return a;
  const int e = a.exponent < b.exponent ? a.exponent : b.exponent;
  return {shifted(a.mantissa, a.exponent - e) + shifted(b.mantissa, b.exponent - e), e};
}
inline Scaled operator-(const Scaled& a) { return {-a.mantissa, a.exponent}; }
inline Scaled operator-(const Scaled& a, const Scaled& b) { return a + (-b); }

/// value * 2^exponent, truncated towards zero to 64 bits and then rounded: relative error <= 2^-52 (below the range of
/// doubles: absolute error one denormal).
inline double to_double(const Integer& value, int exponent = 0) {
  if (value.is_zero()) return 0;
  const Integer magnitude = boost::multiprecision::abs(value);
  const int top = static_cast<int>(boost::multiprecision::msb(magnitude));
  double result = 0;
  if (top > 63) {
    result = static_cast<double>(static_cast<std::uint64_t>(magnitude >> (top - 63)));
    exponent += top - 63;
  } else {
    result = static_cast<double>(static_cast<std::uint64_t>(magnitude));
  }
  return std::ldexp(value.sign() < 0 ? -result : result, exponent);
}
/// value * 2^exponent, truncated to 64 bits: relative error <= 2^-63.
inline long double to_long_double(const Integer& value, int exponent) {
  if (value.is_zero()) return 0;
  const Integer magnitude = boost::multiprecision::abs(value);
  const int top = static_cast<int>(boost::multiprecision::msb(magnitude));
  const int drop = top > 63 ? top - 63 : 0;
  const auto result =
      static_cast<long double>(static_cast<std::uint64_t>(drop > 0 ? Integer(magnitude >> drop) : magnitude));
  return std::ldexp(value.sign() < 0 ? -result : result, exponent + drop);
}
inline double to_double(const Scaled& s) { return to_double(s.mantissa, s.exponent); }

struct IVec {
  Integer x = 0;
  Integer y = 0;
  Integer z = 0;
};
inline IVec operator+(const IVec& a, const IVec& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline IVec operator-(const IVec& a, const IVec& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline IVec operator-(const IVec& a) { return {-a.x, -a.y, -a.z}; }
inline IVec operator*(const IVec& a, const Integer& s) { return {a.x * s, a.y * s, a.z * s}; }
inline Integer dot(const IVec& a, const IVec& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline IVec cross(const IVec& a, const IVec& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline bool is_zero(const IVec& a) { return a.x.is_zero() && a.y.is_zero() && a.z.is_zero(); }

/// The unit vector of `v`, each component within 2^-50 of the exact one. Requires v != 0.
inline Vec3 to_unit(const IVec& v) {
  using boost::multiprecision::abs;
  using boost::multiprecision::msb;
  int top = 0;
  for (const Integer* c : {&v.x, &v.y, &v.z}) {
    if (!c->is_zero()) top = std::max(top, static_cast<int>(msb(abs(*c))));
  }
  return Vec3(to_double(v.x, -top), to_double(v.y, -top), to_double(v.z, -top)).normalized();
}

/// A length known by its square, numerator / denominator * 2^exponent with a positive denominator.
struct ExactLength {
  Integer numerator = 0;
  Integer denominator = 1;
  int exponent = 0;

  /// Sign of (x - length), exact; x >= 0.
  [[nodiscard]] int compare(double x) const { return compare(to_scaled(x)); }
  [[nodiscard]] int compare(const Scaled& s) const {
    const Integer left = s.mantissa * s.mantissa * denominator;
    const int gap = 2 * s.exponent - exponent;
    return (gap >= 0 ? Integer(left << gap) - numerator : left - Integer(numerator << -gap)).sign();
  }
  /// The largest double <= length, and the smallest double >= length.
  [[nodiscard]] double round_down() const {
    double x = approximate();
    while (compare(x) > 0) x = std::nextafter(x, 0.0);
    for (double next = std::nextafter(x, INFINITY); compare(next) <= 0; next = std::nextafter(x, INFINITY)) x = next;
    return x;
  }
  [[nodiscard]] double round_up() const {
    const double x = round_down();
    return compare(x) == 0 ? x : std::nextafter(x, INFINITY);
  }
  /// Sign of (this - other).
  [[nodiscard]] int compare(const ExactLength& other) const {
    Integer left = numerator * other.denominator;
    Integer right = other.numerator * denominator;
    const int gap = exponent - other.exponent;
    if (gap > 0) left <<= gap;
    if (gap < 0) right <<= -gap;
    return (left - right).sign();
  }
  /// Within a few ulp.
  [[nodiscard]] double approximate() const {
    if (numerator.is_zero()) return 0;
    const int top_n = static_cast<int>(boost::multiprecision::msb(numerator));
    const int top_d = static_cast<int>(boost::multiprecision::msb(denominator));
    int e = exponent + top_n - top_d;
    double ratio = to_double(numerator, -top_n) / to_double(denominator, -top_d);
    if (e % 2 != 0) {
      ratio *= 2;
      --e;
    }
    return std::ldexp(std::sqrt(ratio), e / 2);
  }
};

}  // namespace pd::oracle
