/// @file
/// Extreme points of many points along many directions in one pass over memory.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pd/numeric/vector.hpp"

namespace pd::detail {

struct Extremes {
  double least = 0;  ///< min <p, d>, rounded: three products and two sums
  double most = 0;
  std::size_t argument_least = 0;  ///< the lowest of several
  std::size_t argument_most = 0;
};

/// For every direction. Blocks of points stay in the nearest cache while all directions pass over them.
[[nodiscard]] std::vector<Extremes> extreme_points(std::span<const Vec3> points, std::span<const Vec3> directions);

}  // namespace pd::detail
