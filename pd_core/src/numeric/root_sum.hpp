/// @file
/// Numbers of the form base +- sqrt(numerator / denominator) with dyadic parts: every depth and distance of (rounded)
/// polytopes is one. Compared with doubles exactly, rounded exactly.
#pragma once

#include "numeric/double_double.hpp"
#include "numeric/dyadic.hpp"

namespace pd::detail {

class RootSum {
 public:
  /// Two conversions (2^-105 each), a quotient, a root, a difference without cancellation, a product and a quotient:
  /// below 2^-100.
  static constexpr double kApproximationError = 0x1p-98;

  /// base + sign * sqrt(numerator / denominator); numerator >= 0, denominator > 0, sign -1 or +1.
  RootSum(Dyadic base, int sign, Dyadic numerator, Dyadic denominator);

  /// Sign of (value - x), exact.
  [[nodiscard]] int compare(const Dyadic& x) const;
  /// The value, relative error below kApproximationError, however much of the base the root cancels. Parts of it below
  /// 2^-1022 are lost. Requires that base and root lie well within the range of doubles.
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

/// |v| rounded up, exactly.
[[nodiscard]] double length_rounded_up(const Vec3& v);

}  // namespace pd::detail
