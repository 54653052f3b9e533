/// @file
/// The length of a plane vector, with the same bits everywhere: libraries differ in the last bit of std::hypot.
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

}  // namespace pd::detail
