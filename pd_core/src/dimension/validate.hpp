/// @file
/// The checks that every input of this module passes.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "pd/dimension/body.hpp"

namespace pd::dimension::detail {

template <int D>
std::optional<Error> check_points(std::span<const Vector<D>> points) {
  if (points.size() <= D) {
    return Error{ErrorCode::too_few_points,
                 "a body in R^" + std::to_string(D) + " needs at least " + std::to_string(D + 1) +
                     " points, here are " + std::to_string(points.size()),
                 "points"};
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    if ((points[i].array().abs() <= kMaxCoordinate).all()) continue;
    const std::string where = "points[" + std::to_string(i) + "]";
    if (!points[i].allFinite()) return Error{ErrorCode::non_finite, "a point needs finite numbers", where};
    return Error{ErrorCode::out_of_range, "coordinates are limited to 1e100", where};
  }
  return std::nullopt;
}

template <int D>
Error flat_error(const std::string& where) {
  return Error{ErrorCode::not_full_dimensional,
               "the body is flat, or within rounding of a flat one; it must have an interior in R^" + std::to_string(D),
               where};
}

inline std::optional<Error> check_epsilon(double epsilon) {
  if (epsilon > 0 && epsilon < 1) return std::nullopt;
  return Error{ErrorCode::bad_value, "epsilon must lie in (0, 1)", "epsilon"};
}

}  // namespace pd::dimension::detail
