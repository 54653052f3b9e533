/// @file
/// Refusals of a placement or a direction in the plane, and directions that no sum of squares loses.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "pd/numeric/expected.hpp"
#include "pd/planar/polygon.hpp"

namespace pd::detail {

/// Returns non_finite, out_of_range, or nothing.
[[nodiscard]] inline std::optional<Error> refused_point(const Point2& x, const std::string& where) {
  for (const double c : x) {
    if (!std::isfinite(c)) return Error{ErrorCode::non_finite, "two finite numbers are needed", where};
    if (std::abs(c) > 1e300) return Error{ErrorCode::out_of_range, "coordinates are limited to 1e300", where};
  }
  return std::nullopt;
}

/// Returns zero_direction, a refusal of `refused_point`, or nothing.
[[nodiscard]] inline std::optional<Error> refused_direction(const Point2& d, const std::string& where) {
  if (auto refused = refused_point(d, where)) return refused;
  if (d[0] != 0 || d[1] != 0) return std::nullopt;
  return Error{ErrorCode::zero_direction, "a direction needs a length other than zero", where};
}

/// A direction far below 1 times a power of two, exactly: its length, by which one divides, may be no double else.
[[nodiscard]] inline Point2 raised(const Point2& direction) {
  const double size = std::max(std::abs(direction[0]), std::abs(direction[1]));
  if (size >= 0x1p-400) return direction;
  const int exponent = -std::ilogb(size);
  return {std::ldexp(direction[0], exponent), std::ldexp(direction[1], exponent)};
}

}  // namespace pd::detail
