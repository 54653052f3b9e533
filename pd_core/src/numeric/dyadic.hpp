/// @file
/// Exact numbers m * 2^e with an integer m of any length: the last stage of every decision.
///
/// Sums, differences and products of doubles are dyadic, whatever their exponents, so no decision can over- or
/// underflow. About 1000 bits are kept in place; longer mantissas allocate.
#pragma once

#include <bit>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <compare>
#include <utility>

#include "pd/numeric/vector.hpp"

namespace pd::detail {

class Dyadic {
 public:
  using Integer = boost::multiprecision::number<
      boost::multiprecision::cpp_int_backend<1024, 0, boost::multiprecision::signed_magnitude,
                                             boost::multiprecision::unchecked>,
      boost::multiprecision::et_off>;

  Dyadic() = default;
  /// Exact for every finite double.
  Dyadic(double value) {  // NOLINT(google-explicit-constructor): doubles are dyadic
    if (value == 0) return;
    int exponent = 0;
    const double fraction = std::frexp(value, &exponent);
    // An odd mantissa: boxes and grids have short numbers, and products of short numbers are short.
    const auto whole = static_cast<std::int64_t>(fraction * 0x1p53);
    const int zeros = std::countr_zero(static_cast<std::uint64_t>(whole));
    mantissa_ = whole >> zeros;
    exponent_ = exponent - 53 + zeros;
  }

  /// mantissa * 2^exponent.
  static Dyadic from_integer(Integer mantissa, int exponent) {
    Dyadic r;
    r.exponent_ = mantissa.is_zero() ? 0 : exponent;
    r.mantissa_ = std::move(mantissa);
    return r;
  }

  [[nodiscard]] int sign() const { return mantissa_.sign(); }
  [[nodiscard]] const Integer& mantissa() const { return mantissa_; }
  [[nodiscard]] int exponent() const { return exponent_; }

  friend Dyadic operator-(Dyadic a) {
    a.mantissa_ = -a.mantissa_;
    return a;
  }
  friend Dyadic operator+(const Dyadic& a, const Dyadic& b) { return sum(a, b, false); }
  friend Dyadic operator-(const Dyadic& a, const Dyadic& b) { return sum(a, b, true); }
  friend Dyadic operator*(const Dyadic& a, const Dyadic& b) {
    Dyadic r;
    if (a.sign() == 0 || b.sign() == 0) return r;
    multiply(a.mantissa_, b.mantissa_, r.mantissa_);
    r.exponent_ = a.exponent_ + b.exponent_;
    return r;
  }
  friend bool operator==(const Dyadic& a, const Dyadic& b) { return (a - b).sign() == 0; }
  friend std::strong_ordering operator<=>(const Dyadic& a, const Dyadic& b) { return (a - b).sign() <=> 0; }

  /// Multiplication by 2^k.
  [[nodiscard]] Dyadic scaled(int k) const {
    Dyadic r = *this;
    if (sign() != 0) r.exponent_ += k;
    return r;
  }

  /// The largest double <= the value (infinities when out of range).
  [[nodiscard]] double round_down() const;
  /// The smallest double >= the value.
  [[nodiscard]] double round_up() const;
  /// Nearest or a neighbour of the nearest double.
  [[nodiscard]] double to_double() const;

 private:
  static Dyadic sum(const Dyadic& a, const Dyadic& b, bool subtract);
  /// Neither is 0.
  static void multiply(const Integer& a, const Integer& b, Integer& product);

  Integer mantissa_ = 0;
  int exponent_ = 0;
};

struct Dyadic3 {
  Dyadic x, y, z;
};
inline Dyadic3 to_dyadic(const Vec3& v) { return {v.x(), v.y(), v.z()}; }
inline Dyadic3 operator-(const Dyadic3& a, const Dyadic3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Dyadic3 operator+(const Dyadic3& a, const Dyadic3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Dyadic3 operator*(const Dyadic3& a, const Dyadic& s) { return {a.x * s, a.y * s, a.z * s}; }
inline Dyadic dot(const Dyadic3& a, const Dyadic3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Dyadic3 cross(const Dyadic3& a, const Dyadic3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline Dyadic determinant(const Dyadic3& a, const Dyadic3& b, const Dyadic3& c) { return dot(a, cross(b, c)); }

}  // namespace pd::detail
