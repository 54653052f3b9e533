#include "dimension/equal_planes.hpp"

#include <algorithm>
#include <numeric>

namespace pd::dimension::detail {

namespace {

/// Relative difference of normals. Facets closer than this to one another are far below every epsilon.
constexpr double kSamePlane = 1e-9;

}  // namespace

template <int D>
std::vector<std::int32_t> merge_equal_planes(const RadialHull<D>& hull) {
  const auto& facets = hull.facets();
  std::vector<std::int32_t> parent(facets.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](std::int32_t f) {
    while (parent[f] != f) f = parent[f] = parent[parent[f]];
    return f;
  };
  for (std::int32_t f = 0; f < static_cast<std::int32_t>(facets.size()); ++f) {
    if (!hull.alive(f)) continue;
    for (const std::int32_t g : facets[f].neighbour) {
      const double apart = (facets[f].normal - facets[g].normal).squaredNorm();
      if (apart > kSamePlane * kSamePlane * facets[f].normal.squaredNorm()) continue;
      const std::int32_t low = std::min(root(f), root(g)), high = std::max(root(f), root(g));
      parent[high] = low;
    }
  }
  for (std::int32_t f = 0; f < static_cast<std::int32_t>(facets.size()); ++f) parent[f] = hull.alive(f) ? root(f) : -1;
  return parent;
}

template std::vector<std::int32_t> merge_equal_planes<2>(const RadialHull<2>&);
template std::vector<std::int32_t> merge_equal_planes<3>(const RadialHull<3>&);
template std::vector<std::int32_t> merge_equal_planes<4>(const RadialHull<4>&);
template std::vector<std::int32_t> merge_equal_planes<5>(const RadialHull<5>&);

}  // namespace pd::dimension::detail
