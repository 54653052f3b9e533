/// @file
/// An upper bound on the depth from a surface inside P whose expansion stopped early.
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "depth/difference/polytope_difference.hpp"
#include "depth/expansion/inner_surface.hpp"

namespace pd::detail {

/// The least height of P, certified, over the normals of the surface's nearest faces: the support in any direction
/// bounds the depth from above, and the nearest faces' directions bound it well. Time: a few supports.
inline double least_height(const PolytopeDifference& difference, const Surface& surface,
                           std::vector<std::int32_t>& stack, std::int64_t& support_calls) {
  constexpr std::size_t kTried = 8;
  constexpr double kNone = std::numeric_limits<double>::infinity();
  std::array<std::pair<double, int>, kTried> nearest;
  nearest.fill({kNone, -1});
  for (int f = 0; f < surface.slots(); ++f) {
    if (!(surface.key(f) < nearest.back().first)) continue;
    nearest.back() = {surface.key(f), f};
    for (std::size_t k = kTried - 1; k > 0 && nearest[k].first < nearest[k - 1].first; --k) {
      std::swap(nearest[k], nearest[k - 1]);
    }
  }
  double least = kNone;
  for (const auto& [key, f] : nearest) {
    if (f < 0) break;
    const Vec3 unit = surface.normal(f).normalized();
    const DifferenceVertex s = difference.certified_support(unit, difference.support(unit, nullptr), stack);
    ++support_calls;
    least = std::min(least, s.x.dot(unit) + support_plane_error(difference));
  }
  return least;
}

}  // namespace pd::detail
