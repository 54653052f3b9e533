/// @file
/// Numbers of the form base +- sqrt(numerator / denominator) with dyadic parts: every depth and distance of (rounded)
/// polytopes is one. Compared with doubles exactly, rounded exactly.
#pragma once

#include "numeric/double_double.hpp"
#include "numeric/dyadic.hpp"

namespace pd::detail {

class RootSum {
 public:
  /// base + sign * sqrt(numerator / denominator); numerator >= 0, denominator > 0, sign -1 or +1.
  RootSum(Dyadic base, int sign, Dyadic numerator, Dyadic denominator);

  /// Sign of (value - x), exact.
  [[nodiscard]] int compare(const Dyadic& x) const;
  /// The value, absolute error about 2^-100 of the larger of |base| and the root.
  [[nodiscard]] DoubleDouble approximate() const;
  /// The largest double <= value. Requires value >= 0.
  [[nodiscard]] double round_down() const;
  /// The smallest double >= value, given the result of `round_down`.
  [[nodiscard]] double round_up(double down) const;

  [[nodiscard]] RootSum negated() const { return {-base_, -sign_, numerator_, denominator_}; }

 private:
  Dyadic base_;
  int sign_;
  Dyadic numerator_;
  Dyadic denominator_;
};

/// A dyadic number to about 106 bits. Requires that it lies in the range of doubles.
[[nodiscard]] DoubleDouble to_double_double(const Dyadic& value);

/// v / |v| in double-double, whatever the exponents of v. Requires v != 0.
[[nodiscard]] Vec3DD unit_double_double(const Dyadic3& v);

}  // namespace pd::detail
