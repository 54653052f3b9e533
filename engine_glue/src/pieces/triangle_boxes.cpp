#include "pieces/triangle_boxes.hpp"

#include <cmath>
#include <limits>

#include "pd/bullet/scalar.hpp"

namespace pd::detail {

namespace {

/// The lowest 21 bits, two zeros after each.
std::uint64_t spread(std::uint64_t bits) {
  bits &= 0x1FFFFF;
  bits = (bits | bits << 32U) & 0x1F00000000FFFF;
  bits = (bits | bits << 16U) & 0x1F0000FF0000FF;
  bits = (bits | bits << 8U) & 0x100F00F00F00F00F;
  bits = (bits | bits << 4U) & 0x10C30C30C30C30C3;
  return (bits | bits << 2U) & 0x1249249249249249;
}

}  // namespace

void TriangleBoxes::make(std::span<const MeshTriangle> triangles) {
  // 1. Places along the curve: Morton's order of the boxes' middles, in a grid of 1024 cells a side.
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (const MeshTriangle& triangle : triangles) {
    low = low.cwiseMin(to_pd(triangle.lower));
    high = high.cwiseMax(to_pd(triangle.upper));
  }
  const double extent = (high - low).maxCoeff();
  const double scale = extent > 0 && std::isfinite(extent) ? 1023 / extent : 0;
  keys_.clear();
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const Vec3 at = scale * (0.5 * to_pd(triangles[i].lower) + 0.5 * to_pd(triangles[i].upper) - low);
    const auto cell = [&](int axis) { return spread(static_cast<std::uint64_t>(at[axis])); };
    keys_.emplace_back(cell(0) | cell(1) << 1U | cell(2) << 2U, i);
  }
  std::sort(keys_.begin(), keys_.end());

  // 2. Boxes, level by level.
  const auto next_level = [&]() -> std::vector<Box>& {
    if (levels_.size() == num_levels_) levels_.emplace_back();
    std::vector<Box>& level = levels_[num_levels_++];
    level.clear();
    return level;
  };
  order_.clear();
  num_levels_ = 0;
  std::vector<Box>& boxes = next_level();
  for (const auto& [key, i] : keys_) {
    order_.push_back(i);
    boxes.push_back({triangles[i].lower, triangles[i].upper});
  }
  while (levels_[num_levels_ - 1].size() > kGroup) {
    std::vector<Box>& groups = next_level();
    const std::vector<Box>& below = levels_[num_levels_ - 2];
    for (std::size_t i = 0; i < below.size(); ++i) {
      if (i % kGroup == 0) {
        groups.push_back(below[i]);
      } else {
        groups.back().lower.setMin(below[i].lower);
        groups.back().upper.setMax(below[i].upper);
      }
    }
  }
}

}  // namespace pd::detail
