#include "shape/hull/hull_points.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace pd::detail {
namespace {

/// Spreads the low 11 bits of v to every third bit.
std::uint64_t spread_bits(std::uint64_t v) {
  std::uint64_t spread = 0;
  for (int bit = 0; bit < 11; ++bit) spread |= ((v >> bit) & 1U) << (3 * bit);
  return spread;
}

}  // namespace

HullPoints::HullPoints(std::span<const Vec3> source, double max_abs) : source_(source) {
  if (max_abs > 0) {
    int exponent = 0;
    std::frexp(max_abs, &exponent);
    exponent = std::max(exponent, -1000);  // 2^1000 is the largest round factor that is a double with its inverse
    scale_ = std::ldexp(1.0, -exponent);
    unscale_ = std::ldexp(1.0, exponent);
  }
}

void HullPoints::append(std::int32_t id) {
  const Vec3& p = source_[static_cast<std::size_t>(id)];
  // + 0.0 turns -0 into +0: equal points must have equal bits.
  const HullPoint scaled{p.x() * scale_ + 0.0, p.y() * scale_ + 0.0, p.z() * scale_ + 0.0, id, -1};
  if (scale_ < 1) {
    scaling_exact_ =
        scaling_exact_ && scaled.x * unscale_ == p.x() && scaled.y * unscale_ == p.y() && scaled.z * unscale_ == p.z();
  }
  points_.push_back(scaled);
}

void HullPoints::sort_spatially(int first) {
  const std::size_t n = points_.size() - static_cast<std::size_t>(first);
  std::array<double, 3> low;
  std::array<double, 3> high;
  low.fill(2);
  high.fill(-2);
  for (std::size_t i = static_cast<std::size_t>(first); i < points_.size(); ++i) {
    const std::array<double, 3> p{points_[i].x, points_[i].y, points_[i].z};
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], p[k]);
      high[k] = std::max(high[k], p[k]);
    }
  }
  constexpr int kCells = 2048;
  std::array<std::uint64_t, kCells> spread;
  for (std::size_t i = 0; i < kCells; ++i) spread[i] = spread_bits(i);
  struct Keyed {
    std::uint64_t code;
    std::uint32_t index;
  };
  std::array<double, 3> cells_per_length;
  for (std::size_t k = 0; k < 3; ++k) {
    cells_per_length[k] = high[k] > low[k] ? std::min((kCells - 0.5) / (high[k] - low[k]), 1e300) : 0;
  }
  std::vector<Keyed> keys(n);
  for (std::size_t i = 0; i < n; ++i) {
    const HullPoint& p = points_[static_cast<std::size_t>(first) + i];
    const auto cell = [&](double v, std::size_t k) {
      return spread[static_cast<std::size_t>(std::clamp((v - low[k]) * cells_per_length[k], 0.0, kCells - 1.0))];
    };
    keys[i] = {cell(p.x, 0) | (cell(p.y, 1) << 1) | (cell(p.z, 2) << 2), static_cast<std::uint32_t>(i)};
  }
  std::vector<Keyed> sorted(n);
  for (int shift = 0; shift < 33; shift += 11) {
    std::array<std::uint32_t, 2049> start{};
    for (const Keyed& key : keys) ++start[((key.code >> shift) & 2047U) + 1];
    for (std::size_t i = 1; i < start.size(); ++i) start[i] += start[i - 1];
    for (const Keyed& key : keys) sorted[start[(key.code >> shift) & 2047U]++] = key;
    keys.swap(sorted);
  }
  const std::vector<HullPoint> unsorted(points_.begin() + first, points_.end());
  for (std::size_t i = 0; i < n; ++i) points_[static_cast<std::size_t>(first) + i] = unsorted[keys[i].index];
}

bool HullPoints::less(int i, int j) const {
  const Vec3 p = decisive(i);
  const Vec3 q = decisive(j);
  for (int k = 0; k < 3; ++k) {
    if (p[k] != q[k]) return p[k] < q[k];
  }
  return (*this)[i].id < (*this)[j].id;
}

bool HullPoints::equal(int i, int j) const { return decisive(i) == decisive(j); }

int HullPoints::orient3d(int a, int b, int c, int d) const {
  return pd::orient3d(decisive(a), decisive(b), decisive(c), decisive(d));
}

int HullPoints::orient2d(int a, int b, int c, int axis) const {
  const int u = (axis + 1) % 3;
  const int v = (axis + 2) % 3;
  const Vec3 p = decisive(a);
  const Vec3 q = decisive(b);
  const Vec3 r = decisive(c);
  return pd::orient2d({p[u], p[v]}, {q[u], q[v]}, {r[u], r[v]});
}

bool HullPoints::collinear(int a, int b, int c) const { return pd::collinear(decisive(a), decisive(b), decisive(c)); }

}  // namespace pd::detail
