/// @file
/// A double with a bound on its absolute error: the filter in front of dyadic numbers. One template computes an
/// expression in both, and the dyadic one is asked only where the bound leaves the sign open.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "numeric/dyadic.hpp"

namespace pd::detail {

/// |true value - value| <= error. Where something overflows the error is no longer finite and no sign is claimed.
struct Estimate {
  double value = 0;
  double error = 0;

  Estimate() = default;
  Estimate(double exact) : value(exact) {}  // NOLINT(google-explicit-constructor): doubles are exact
  Estimate(double v, double e) : value(v), error(e) {}

  /// 1 or -1 where it is certain, 0 where it is not (or where the value is exactly 0: then is_zero() is true).
  [[nodiscard]] int certain_sign() const { return value > error ? 1 : (-value > error ? -1 : 0); }
  [[nodiscard]] bool is_zero() const { return value == 0 && error == 0; }
};

namespace estimate {
/// Above half an ulp, relative: covers the rounding of a result and, with kSlack, those of the bound itself.
inline constexpr double kRounding = 0x1.0000000001p-53;
inline constexpr double kSlack = 1 + 0x1p-48;
/// Above what a product can lose by underflow.
inline constexpr double kUnderflow = 0x1p-1070;
}  // namespace estimate

namespace estimate {
/// True if a double has at most 24 leading bits, and a size whose square neither overflows nor loses bits: a product of
/// two such numbers is exact. It looks at the bits, since GCC 12 folds a conversion to float and back where it
/// vectorises.
inline bool is_short(double a) {
  constexpr std::uint64_t kLastBits = (std::uint64_t{1} << (std::numeric_limits<double>::digits - 24)) - 1;
  const double size = std::abs(a);
  return (std::bit_cast<std::uint64_t>(a) & kLastBits) == 0 && size < 0x1p500 && (size > 0x1p-400 || a == 0);
}
/// True if v = a + b without rounding: Knuth's two-sum, whose rest is 0. False where something overflows.
inline bool is_exact_sum(double a, double b, double v) {
  const double of_b = v - a;
  return (a - (v - of_b)) + (b - of_b) == 0;
}
}  // namespace estimate

// Sums and products of exact numbers that are exact keep the error 0. Without this, every zero of a lattice (collinear
// edges, common corners) would take big numbers.

inline Estimate operator-(const Estimate& a) { return {-a.value, a.error}; }
inline Estimate operator+(const Estimate& a, const Estimate& b) {
  const double v = a.value + b.value;
  if (a.error == 0 && b.error == 0 && estimate::is_exact_sum(a.value, b.value, v)) return {v, 0};
  return {v, (a.error + b.error + estimate::kRounding * std::abs(v)) * estimate::kSlack};
}
inline Estimate operator-(const Estimate& a, const Estimate& b) {
  const double v = a.value - b.value;
  if (a.error == 0 && b.error == 0 && estimate::is_exact_sum(a.value, -b.value, v)) return {v, 0};
  return {v, (a.error + b.error + estimate::kRounding * std::abs(v)) * estimate::kSlack};
}
inline Estimate operator*(const Estimate& a, const Estimate& b) {
  if (a.is_zero() || b.is_zero()) return {};  // axis-parallel edges: no big number is asked for their exact zeros
  const double v = a.value * b.value;
  if (a.error == 0 && b.error == 0 && estimate::is_short(a.value) && estimate::is_short(b.value)) return {v, 0};
  return {v, (std::abs(a.value) * b.error + std::abs(b.value) * a.error + a.error * b.error +
              estimate::kRounding * std::abs(v)) *
                     estimate::kSlack +
                 estimate::kUnderflow};
}

/// The sign of an expression. `expression.template operator()<N>()` computes it in the number type N.
template <class Expression>
int exact_sign(const Expression& expression) {
  const Estimate estimate = expression.template operator()<Estimate>();
  const int sign = estimate.certain_sign();
  if (sign != 0 || estimate.is_zero()) return sign;
  return expression.template operator()<Dyadic>().sign();
}

}  // namespace pd::detail
