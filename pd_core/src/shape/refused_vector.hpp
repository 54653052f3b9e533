/// @file
/// The reasons for which queries refuse a direction or a point.
#pragma once

#include <optional>

#include "pd/numeric/expected.hpp"
#include "pd/shape/pose.hpp"

namespace pd::detail {

[[nodiscard]] inline std::optional<Error> refuse_direction(const Vec3& direction) {
  if (!direction.allFinite()) {
    return Error{ErrorCode::non_finite, "a direction needs three finite numbers", "direction"};
  }
  if (direction.isZero(0)) {
    return Error{ErrorCode::zero_direction, "a direction needs a length other than zero", "direction"};
  }
  return std::nullopt;
}

[[nodiscard]] inline std::optional<Error> refuse_point(const Vec3& point) {
  if (!point.allFinite()) return Error{ErrorCode::non_finite, "a point needs three finite numbers", "point"};
  if (point.cwiseAbs().maxCoeff() > kMaxCoordinate) {
    return Error{ErrorCode::out_of_range, "coordinates are limited to 1e300", "point"};
  }
  return std::nullopt;
}

}  // namespace pd::detail
