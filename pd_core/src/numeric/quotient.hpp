/// @file
/// Ratios of exact numbers: rounded, and compared.
#pragma once

#include "numeric/dyadic.hpp"

namespace pd::detail {

/// The place of the highest bit of |x|, x != 0.
[[nodiscard]] inline int top_bit(const Dyadic::Integer& x) {
  return static_cast<int>(boost::multiprecision::msb(boost::multiprecision::abs(x)));
}

/// numerator / denominator in doubles, within 2^-100 and a rounding, whatever the exponents of the two.
[[nodiscard]] double quotient(const Dyadic& numerator, const Dyadic& denominator);

/// The square of a length as numerator / denominator, denominator > 0.
struct SquaredRatio {
  Dyadic numerator;
  Dyadic denominator;
};
/// Sign of x - y, exact.
[[nodiscard]] inline int compare(const SquaredRatio& x, const SquaredRatio& y) {
  return (x.numerator * y.denominator - y.numerator * x.denominator).sign();
}

}  // namespace pd::detail
