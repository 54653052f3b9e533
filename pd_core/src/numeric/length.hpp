/// @file
/// The length of a vector, with the same bits everywhere: libraries differ in the last bit of std::hypot, and Eigen's
/// stableNorm adds squares up in an order that hangs on where the vector lies in memory.
#pragma once

#include <algorithm>
#include <cmath>

namespace pd::detail {

/// sqrt(x^2 + y^2) within 2^-51 of itself, without overflow or underflow on the way; infinite or NaN where x or y is.
[[nodiscard]] inline double length(double x, double y) {
  const double largest = std::max(std::abs(x), std::abs(y));
  if (!(largest > 0) || !std::isfinite(x) || !std::isfinite(y)) return std::abs(x) + std::abs(y);
  // No square overflows, and what underflows is nothing beside the other: the same bits as below.
  if (largest > 0x1p-400 && largest < 0x1p400) return std::sqrt(x * x + y * y);
  const int exponent = std::ilogb(largest);
  x = std::ldexp(x, -exponent);
  y = std::ldexp(y, -exponent);
  return std::ldexp(std::sqrt(x * x + y * y), exponent);
}

/// The same of a vector of few coordinates: within 2^-50 of itself for up to six.
template <class Vector>
[[nodiscard]] double length(const Vector& v) {
  const double largest = v.cwiseAbs().maxCoeff();
  if (!(largest > 0) || !v.allFinite()) return v.cwiseAbs().sum();
  const int exponent = largest > 0x1p-400 && largest < 0x1p400 ? 0 : std::ilogb(largest);
  double squares = 0;
  for (int i = 0; i < static_cast<int>(v.size()); ++i) {
    const double x = exponent == 0 ? v[i] : std::ldexp(v[i], -exponent);
    squares += x * x;
  }
  const double root = std::sqrt(squares);
  return exponent == 0 ? root : std::ldexp(root, exponent);
}

/// A finite vector but 0 over its length. Eigen's own is no unit vector where the length overflows or is subnormal.
template <class Vector>
[[nodiscard]] Vector unit_vector(const Vector& v) {
  const double largest = v.cwiseAbs().maxCoeff();
  if (largest > 0x1p-900 && largest < 0x1p900) return v.stableNormalized();
  const int exponent = std::ilogb(largest);
  return Vector(v.unaryExpr([=](double x) { return std::ldexp(x, -exponent); })).normalized();
}

}  // namespace pd::detail
