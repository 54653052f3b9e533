#include "numeric/quotient.hpp"

#include <cmath>

#include "numeric/root_sum.hpp"

namespace pd::detail {

double quotient(const Dyadic& numerator, const Dyadic& denominator) {
  if (numerator.sign() == 0) return 0;
  const int above = top_bit(numerator.mantissa()) + numerator.exponent();
  const int below = top_bit(denominator.mantissa()) + denominator.exponent();
  const DoubleDouble ratio = to_double_double(numerator.scaled(-above)) / to_double_double(denominator.scaled(-below));
  return std::ldexp(to_double(ratio), above - below);
}

}  // namespace pd::detail
