#include "shape/hull/point_survey.hpp"

#include <algorithm>
#include <array>
#include <limits>

namespace pd::detail {
namespace {

constexpr int kSurveyBlock = 512;
constexpr int kSurveyLanes = 8;

/// Consecutive points, coordinate by coordinate; the last block is filled up with its first point.
struct SurveyBlock {
  std::array<double, kSurveyBlock> x, y, z;

  void load(std::span<const Vec3> points, double scale) {
    const std::size_t n = points.size();
    for (std::size_t i = 0; i < n; ++i) {
      x[i] = points[i].x() * scale;
      y[i] = points[i].y() * scale;
      z[i] = points[i].z() * scale;
    }
    std::fill(x.begin() + static_cast<std::ptrdiff_t>(n), x.end(), x[0]);
    std::fill(y.begin() + static_cast<std::ptrdiff_t>(n), y.end(), y[0]);
    std::fill(z.begin() + static_cast<std::ptrdiff_t>(n), z.end(), z[0]);
  }
};

template <class Visit>
void for_each_block(std::span<const Vec3> points, double scale, Visit visit) {
  SurveyBlock block;
  for (std::size_t begin = 0; begin < points.size(); begin += kSurveyBlock) {
    const std::size_t count = std::min<std::size_t>(kSurveyBlock, points.size() - begin);
    block.load(points.subspan(begin, count), scale);
    visit(block, begin, count);
  }
}

/// Least and greatest value of one line, and who has them.
struct LineRange {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  std::int32_t lowest = -1;
  std::int32_t highest = -1;

  /// The common case is that nothing in the block is further out; only then is it searched for who it is.
  template <class Value>
  void include(const Value& value, std::size_t begin) {
    std::array<double, kSurveyLanes> least;
    std::array<double, kSurveyLanes> most;
    for (int lane = 0; lane < kSurveyLanes; ++lane) least[lane] = most[lane] = value(lane);
    for (int i = kSurveyLanes; i < kSurveyBlock; i += kSurveyLanes) {
      for (int lane = 0; lane < kSurveyLanes; ++lane) {
        const double v = value(i + lane);
        least[lane] = v < least[lane] ? v : least[lane];
        most[lane] = v > most[lane] ? v : most[lane];
      }
    }
    const double block_low = *std::min_element(least.begin(), least.end());
    const double block_high = *std::max_element(most.begin(), most.end());
    const auto position = [&](double extreme) {
      int i = 0;
      while (value(i) != extreme) ++i;
      return static_cast<std::int32_t>(begin) + i;
    };
    if (block_low < low) {
      low = block_low;
      lowest = position(low);
    }
    if (block_high > high) {
      high = block_high;
      highest = position(high);
    }
  }
};

}  // namespace

std::vector<std::int32_t> extreme_points(std::span<const Vec3> points) {
  std::array<LineRange, 13> lines;
  for_each_block(points, 1, [&](const SurveyBlock& b, std::size_t begin, std::size_t) {
    const auto include = [&](std::size_t line, auto value) { lines[line].include(value, begin); };
    include(0, [&](int i) { return b.x[i]; });
    include(1, [&](int i) { return b.y[i]; });
    include(2, [&](int i) { return b.z[i]; });
    include(3, [&](int i) { return b.x[i] + b.y[i]; });
    include(4, [&](int i) { return b.x[i] - b.y[i]; });
    include(5, [&](int i) { return b.x[i] + b.z[i]; });
    include(6, [&](int i) { return b.x[i] - b.z[i]; });
    include(7, [&](int i) { return b.y[i] + b.z[i]; });
    include(8, [&](int i) { return b.y[i] - b.z[i]; });
    include(9, [&](int i) { return b.x[i] + b.y[i] + b.z[i]; });
    include(10, [&](int i) { return b.x[i] + b.y[i] - b.z[i]; });
    include(11, [&](int i) { return b.x[i] - b.y[i] + b.z[i]; });
    include(12, [&](int i) { return b.x[i] - b.y[i] - b.z[i]; });
  });
  std::vector<std::int32_t> extremes;
  for (const LineRange& line : lines) {
    extremes.push_back(line.lowest);
    extremes.push_back(line.highest);
  }
  std::sort(extremes.begin(), extremes.end());
  extremes.erase(std::unique(extremes.begin(), extremes.end()), extremes.end());
  return extremes;
}

std::vector<std::int32_t> points_not_inside(std::span<const Vec3> points, double scale,
                                            const std::vector<HullTriangle>& hull) {
  std::vector<std::int32_t> outside;
  std::array<double, kSurveyBlock> highest;
  for_each_block(points, scale, [&](const SurveyBlock& b, std::size_t begin, std::size_t count) {
    highest.fill(-std::numeric_limits<double>::infinity());
    for (const HullTriangle& t : hull) {
      const double nx = t.normal[0];
      const double ny = t.normal[1];
      const double nz = t.normal[2];
      // The plane moved inwards by its error; the slack of HullTriangle::error covers the rounding here.
      const double offset = t.offset - t.error;
      for (int i = 0; i < kSurveyBlock; ++i) {
        const double height = nx * b.x[i] + ny * b.y[i] + nz * b.z[i] - offset;
        highest[i] = height > highest[i] ? height : highest[i];
      }
    }
    for (std::size_t i = 0; i < count; ++i) {
      if (highest[i] >= 0) outside.push_back(static_cast<std::int32_t>(begin + i));
    }
  });
  return outside;
}

}  // namespace pd::detail
