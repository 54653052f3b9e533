/// @file
/// The checks that every input of this module passes.
#pragma once

#include <cmath>
#include <optional>
#include <span>
#include <string>

#include "dimension/any_dimension.hpp"

namespace pd::dimension::detail {

inline Error too_few_points_error(std::int64_t count, int dimension) {
  return {ErrorCode::too_few_points,
          "a body in R^" + std::to_string(dimension) + " needs at least " + std::to_string(dimension + 1) +
              " points, here are " + std::to_string(count),
          "points"};
}

/// @param first  index of the first point in the input.
inline std::optional<Error> check_coordinates(const Points& points, std::int64_t first) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    if ((points[i].array().abs() <= kMaxCoordinate).all()) continue;
    const std::string where = "points[" + std::to_string(first + static_cast<std::int64_t>(i)) + "]";
    if (!points[i].allFinite()) return Error{ErrorCode::non_finite, "a point needs finite numbers", where};
    return Error{ErrorCode::out_of_range, "coordinates are limited to 1e100", where};
  }
  return std::nullopt;
}

inline std::optional<Error> check_points(const Points& points) {
  const auto count = static_cast<std::int64_t>(points.size());
  if (count <= points.dimension()) return too_few_points_error(count, points.dimension());
  return check_coordinates(points, 0);
}

/// Aspects beyond this are flat within rounding (2^-53 of the longest extent, with room for a few products).
inline constexpr double kThinnest = 0x1p-40;

inline bool too_thin(const AnySandwich& sandwich) {
  const AnyMatrix axes = sandwich_box(sandwich).axes;
  double longest = 0, shortest = axes.col(0).norm();
  for (int k = 0; k < axes.cols(); ++k) {
    longest = std::max(longest, axes.col(k).norm());
    shortest = std::min(shortest, axes.col(k).norm());
  }
  // Written so that a NaN is thin.
  return !(shortest > kThinnest * longest);
}

inline Error flat_error(const std::string& where, int dimension) {
  return Error{
      ErrorCode::not_full_dimensional,
      "the body is flat, or within rounding of a flat one; it must have an interior in R^" + std::to_string(dimension),
      where};
}

inline std::optional<Error> check_epsilon(double epsilon) {
  if (epsilon > 0 && epsilon < 1) return std::nullopt;
  return Error{ErrorCode::bad_value, "epsilon must lie in (0, 1)", "epsilon"};
}

}  // namespace pd::dimension::detail
