/// @file
/// The checks that every input of this module passes.
#pragma once

#include <cmath>
#include <optional>
#include <span>
#include <string>

#include "pd/dimension/body.hpp"

namespace pd::dimension::detail {

template <int D>
Error too_few_points_error(std::int64_t count) {
  return {ErrorCode::too_few_points,
          "a body in R^" + std::to_string(D) + " needs at least " + std::to_string(D + 1) + " points, here are " +
              std::to_string(count),
          "points"};
}

/// @param first  index of the first point in the input.
template <int D>
std::optional<Error> check_coordinates(std::span<const Vector<D>> points, std::int64_t first) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    if ((points[i].array().abs() <= kMaxCoordinate).all()) continue;
    const std::string where = "points[" + std::to_string(first + static_cast<std::int64_t>(i)) + "]";
    if (!points[i].allFinite()) return Error{ErrorCode::non_finite, "a point needs finite numbers", where};
    return Error{ErrorCode::out_of_range, "coordinates are limited to 1e100", where};
  }
  return std::nullopt;
}

template <int D>
std::optional<Error> check_points(std::span<const Vector<D>> points) {
  if (points.size() <= D) return too_few_points_error<D>(static_cast<std::int64_t>(points.size()));
  return check_coordinates<D>(points, 0);
}

/// Aspects beyond this are flat within rounding (2^-53 of the longest extent, with room for a few products).
inline constexpr double kThinnest = 0x1p-40;

template <int D>
bool too_thin(const Sandwich<D>& sandwich) {
  const Matrix<D> axes = sandwich_box(sandwich).axes;
  double longest = 0, shortest = axes.col(0).norm();
  for (int k = 0; k < D; ++k) {
    longest = std::max(longest, axes.col(k).norm());
    shortest = std::min(shortest, axes.col(k).norm());
  }
  // Written so that a NaN is thin.
  return !(shortest > kThinnest * longest);
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
