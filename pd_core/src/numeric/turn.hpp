/// @file
/// Sines and rotations with the same bits everywhere: libraries differ in the last bit of std::sin.
#pragma once

#include <cmath>

#include "pd/numeric/vector.hpp"

namespace pd::detail {

/// sin(x) / x - 1 (`first` 1) or cos(x) - 1 (`first` 0) by their series in `square` = x^2. For |x| <= pi/4 what is left
/// out is below 2^-63 of the sum.
[[nodiscard]] inline double alternating_series(double square, int first) {
  double sum = 0;
  for (int k = first + 16; k > first; k -= 2) sum = -square / (k * (k - 1)) * (1 + sum);
  return sum;
}

/// sin(angle), off by 2^-51 of itself and, beyond 1e6, by 2^-52 of the angle. Requires: it is finite.
[[nodiscard]] inline double sine(double angle) {
  constexpr double kTwoOverPi = 0x1.45f306dc9c883p-1;
  // pi/2 in parts of 33 bits: products with fewer than 2^20 quarter turns are exact.
  constexpr double kQuarter = 0x1.921fb544p+0;
  constexpr double kQuarterRest = 0x1.0b4611a6p-34;
  constexpr double kQuarterLast = 0x1.3198a2e037073p-69;
  constexpr double kTurn = 0x1.921fb54442d18p+2;
  if (std::abs(angle) > 1e6) angle = std::fmod(angle, kTurn);
  const double quarters = std::floor(angle * kTwoOverPi + 0.5);
  const double x = ((angle - quarters * kQuarter) - quarters * kQuarterRest) - quarters * kQuarterLast;
  const auto quadrant = static_cast<int>(quarters - 4 * std::floor(0.25 * quarters));
  const double value = quadrant % 2 == 0 ? x + x * alternating_series(x * x, 1) : 1 + alternating_series(x * x, 0);
  return quadrant < 2 ? value : -value;
}

/// sin(angle) and 1 - cos(angle), which keeps its digits.
struct Turn {
  double sine;
  double versine;
};
[[nodiscard]] inline Turn turn_by(double angle) {
  const double half = sine(0.5 * angle);
  return {sine(angle), 2 * half * half};
}

/// v turned about a unit axis (Rodrigues' formula).
[[nodiscard]] inline Vec3 turned(const Vec3& v, const Vec3& axis, const Turn& turn) {
  const Vec3 across = axis.cross(v);
  return v + turn.sine * across + turn.versine * axis.cross(across);
}
[[nodiscard]] inline Vec3 turned(const Vec3& v, const Vec3& axis, double angle) {
  return turned(v, axis, turn_by(angle));
}

/// The rotation by `angle` about a unit axis.
[[nodiscard]] inline Mat3 rotation_about(const Vec3& axis, double angle) {
  const Turn turn = turn_by(angle);
  Mat3 cross;
  cross << 0, -axis.z(), axis.y(), axis.z(), 0, -axis.x(), -axis.y(), axis.x(), 0;
  return Mat3::Identity() + turn.sine * cross + turn.versine * (cross * cross);
}

}  // namespace pd::detail
