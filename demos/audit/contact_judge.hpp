/// @file
/// The judge: what an engine reported of a pair against the exact answer.
///
/// x is the exact signed depth: the depth, or minus the distance; L the largest |coordinate| of P = B + (-A), margins
/// and curved parts included; n the reported normal made unit; h_P(n) = max_B <b,n> - min_A <a,n>. Where x is known as
/// a bracket (curved bodies, compounds), counts need the whole bracket and errors are distances to it.
///
/// A half-space has no such L: there it is that of the other body seen from the plane's point nearest to it. Nor has
/// it a finite h_P in any direction but its normal: there the way that leads out along n takes its place.
#pragma once

#include <optional>

#include "audit/record_reader.hpp"
#include "pd/depth/scratch.hpp"

namespace pd::audit {

struct Judgement {
  bool answered = false;  ///< false: no exact answer within the limits, or a bracket wider than tolerance * L
  double lower = 0;       ///< lower <= x <= upper, certified
  double upper = 0;
  double scale = 0;  ///< L

  bool missed = false;   ///< x > tolerance * L, and nothing reported or a depth <= 0
  bool phantom = false;  ///< x < - tolerance * L and reported depth > 0
  // Empty where a column does not apply to the contact.
  std::optional<double> depth_error;             ///< (reported depth - x) / L, signed
  std::optional<double> depth_error_of_smaller;  ///< over the largest extent of the smaller body
  std::optional<double> depth_error_absolute;    ///< in the unit of the record
  std::optional<double> normal_excess;           ///< (h_P(n) - x) / L, >= 0 up to rounding, for x > 0
  std::optional<double> point_error;             ///< largest distance of a reported position from its surface, / L

  // What a recorder may have got wrong, not the engine: far off as it stands, near with the other sign.
  bool normal_turned = false;
  bool depth_turned = false;
};

/// Errors from here on, relative to L, are looked at with the other sign.
inline constexpr double kFarOff = 1e-3;

/// Ways that lead nowhere out of a half-space are as bad as one this many times L long.
inline constexpr double kNoWayOut = 1e9;

/// @param tolerance  > 0, relative to L.
[[nodiscard]] Judgement judge(const RecordedContact& contact, double tolerance, Scratch& scratch);

/// L; > 0 but for two points that coincide.
[[nodiscard]] double contact_scale(const RecordedContact& contact);

}  // namespace pd::audit
