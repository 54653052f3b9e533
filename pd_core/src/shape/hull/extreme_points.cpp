#include "shape/hull/extreme_points.hpp"

#include <algorithm>
#include <limits>

#include "numeric/instruction_sets.hpp"

namespace pd::detail {

namespace {

constexpr std::size_t kBlock = 512;  ///< points; three arrays of doubles, 12 KiB
constexpr std::size_t kLanes = 16;

struct Block {
  alignas(64) double x[kBlock];
  alignas(64) double y[kBlock];
  alignas(64) double z[kBlock];
};

typedef double Lanes __attribute__((vector_size(32)));
constexpr std::size_t kWidth = 4;
constexpr std::size_t kRows = kLanes / kWidth;

struct Range {
  double least;
  double most;
};

PD_INLINE void heights(Lanes& to, const Block& block, std::size_t i, double dx, double dy, double dz) {
  Lanes x, y, z;
  __builtin_memcpy(&x, block.x + i, sizeof(Lanes));
  __builtin_memcpy(&y, block.y + i, sizeof(Lanes));
  __builtin_memcpy(&z, block.z + i, sizeof(Lanes));
  to = x * dx + y * dy + z * dz;
}

/// Of a block whose size is a multiple of kLanes; four rows of lanes, so that comparisons do not wait for each other.
PD_CLONES Range range_of(const Block& block, std::size_t size, double dx, double dy, double dz) {
  Lanes low[kRows], high[kRows];
  for (std::size_t r = 0; r < kRows; ++r) {
    heights(low[r], block, kWidth * r, dx, dy, dz);
    high[r] = low[r];
  }
  for (std::size_t i = kLanes; i < size; i += kLanes) {
    for (std::size_t r = 0; r < kRows; ++r) {
      Lanes next;
      heights(next, block, i + kWidth * r, dx, dy, dz);
      low[r] = next < low[r] ? next : low[r];
      high[r] = next > high[r] ? next : high[r];
    }
  }
  Range range{low[0][0], high[0][0]};
  for (std::size_t r = 0; r < kRows; ++r) {
    for (std::size_t l = 0; l < kWidth; ++l) {
      range.least = low[r][l] < range.least ? low[r][l] : range.least;
      range.most = high[r][l] > range.most ? high[r][l] : range.most;
    }
  }
  return range;
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
      const auto [least, most] = range_of(block, padded, d.x(), d.y(), d.z());
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
