#include "shape/extreme_points.hpp"

#include <algorithm>
#include <limits>

namespace pd::detail {

namespace {

constexpr std::size_t kBlock = 512;  ///< points; three arrays of doubles, 12 KiB
constexpr std::size_t kLanes = 8;

struct Block {
  alignas(64) double x[kBlock];
  alignas(64) double y[kBlock];
  alignas(64) double z[kBlock];
};

/// Least and most of a block, whose size is a multiple of kLanes, lane by lane so that compilers vectorise it.
void range_of(const Block& block, std::size_t size, double dx, double dy, double dz, double& least, double& most) {
  double low[kLanes], high[kLanes];
  std::fill(low, low + kLanes, std::numeric_limits<double>::infinity());
  std::fill(high, high + kLanes, -std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < size; i += kLanes) {
    for (std::size_t l = 0; l < kLanes; ++l) {
      const double value = block.x[i + l] * dx + block.y[i + l] * dy + block.z[i + l] * dz;
      low[l] = value < low[l] ? value : low[l];
      high[l] = value > high[l] ? value : high[l];
    }
  }
  least = *std::min_element(low, low + kLanes);
  most = *std::max_element(high, high + kLanes);
}

/// The first point of a block with this value.
std::size_t find(const Block& block, double dx, double dy, double dz, double value) {
  std::size_t i = 0;
  while (block.x[i] * dx + block.y[i] * dy + block.z[i] * dz != value) ++i;
  return i;
}

}  // namespace

std::vector<Extremes> extreme_points(std::span<const Vec3> points, std::span<const Vec3> directions) {
  std::vector<Extremes> extremes(
      directions.size(), {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(), 0, 0});
  Block block;
  for (std::size_t start = 0; start < points.size(); start += kBlock) {
    const std::size_t count = std::min(kBlock, points.size() - start);
    const std::size_t padded = (count + kLanes - 1) / kLanes * kLanes;
    for (std::size_t i = 0; i < padded; ++i) {
      const Vec3& p = points[start + std::min(i, count - 1)];
      block.x[i] = p.x();
      block.y[i] = p.y();
      block.z[i] = p.z();
    }
    for (std::size_t k = 0; k < directions.size(); ++k) {
      const Vec3& d = directions[k];
      Extremes& e = extremes[k];
      double least = 0, most = 0;
      range_of(block, padded, d.x(), d.y(), d.z(), least, most);
      if (least < e.least) {
        e.least = least;
        e.argument_least = start + find(block, d.x(), d.y(), d.z(), least);
      }
      if (most > e.most) {
        e.most = most;
        e.argument_most = start + find(block, d.x(), d.y(), d.z(), most);
      }
    }
  }
  return extremes;
}

}  // namespace pd::detail
