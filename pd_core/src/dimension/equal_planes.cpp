#include "dimension/equal_planes.hpp"

#include <algorithm>
#include <numeric>

namespace pd::dimension::detail {

namespace {

/// Relative difference of normals. Facets closer than this to one another are far below every epsilon.
constexpr double kSamePlane = 1e-9;

}  // namespace

std::vector<std::int32_t> merge_equal_planes(const RadialHull& hull) {
  const auto& facets = hull.facets();
  std::vector<std::int32_t> parent(facets.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](std::int32_t f) {
    while (parent[f] != f) f = parent[f] = parent[parent[f]];
    return f;
  };
  for (std::int32_t f = 0; f < static_cast<std::int32_t>(facets.size()); ++f) {
    if (!hull.alive(f)) continue;
    for (const std::int32_t g : hull.neighbours_of(f)) {
      const double apart = (hull.normal(f) - hull.normal(g)).squaredNorm();
      if (apart > kSamePlane * kSamePlane * hull.normal(f).squaredNorm()) continue;
      const std::int32_t low = std::min(root(f), root(g)), high = std::max(root(f), root(g));
      parent[high] = low;
    }
  }
  for (std::int32_t f = 0; f < static_cast<std::int32_t>(facets.size()); ++f) parent[f] = hull.alive(f) ? root(f) : -1;
  return parent;
}

}  // namespace pd::dimension::detail
