/// @file
/// Sums of doubles, and of their products, that know whether they are exact: boxes, grids and integers need nothing
/// more, and where a step rounds the caller goes on with longer numbers.
#pragma once

#include <cmath>

#include "numeric/double_double.hpp"

namespace pd::detail {

class UnroundedSum {
 public:
  void add(double x) {
    const DoubleDouble s = two_sum(value_, x);
    value_ = s.hi;
    exact_ = exact_ && s.lo == 0;  // NaN, of numbers out of range, is not 0 either
  }
  void add_product(double a, double b) {
    if (a == 0 || b == 0) return;
    if (std::abs(a) == 1) {
      add(a * b);
      return;
    }
    const DoubleDouble p = two_product(a, b);
    exact_ = exact_ && p.lo == 0 && std::abs(p.hi) > kLeastProduct;
    add(p.hi);
  }
  [[nodiscard]] bool exact() const { return exact_; }
  /// Requires exact().
  [[nodiscard]] double value() const { return value_; }

 private:
  static constexpr double kLeastProduct = 0x1p-900;  ///< below it the error of a product may be lost

  double value_ = 0;
  bool exact_ = true;
};

/// a += b where the sum has no more than two parts. @return whether that is so; a is rounded where it is not.
inline bool add_exactly(DoubleDouble& a, double b) {
  const DoubleDouble high = two_sum(a.hi, b);
  const DoubleDouble low = two_sum(high.lo, a.lo);
  a = two_sum(high.hi, low.hi);
  return low.lo == 0;
}

}  // namespace pd::detail
