/// @file
/// Sums of two triangles in doubles: most pairs of a candidate and a sum lie apart, or the one inside the other, by far
/// more than rounding. Only the rest take exact signs.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "planar/boundary/convex_sum.hpp"

namespace pd::detail {

class RoughSums {
 public:
  enum class Where { holds, apart, unclear };

  /// Requires sums of triangles: six corners at most.
  explicit RoughSums(const std::vector<ConvexSum>& sums) {
    double size = 0;
    rough_.reserve(sums.size());
    for (const ConvexSum& sum : sums) {
      Rough& rough = rough_.emplace_back();
      rough.count = sum.size();
      for (int t = 0; t < sum.size(); ++t) {
        const SumPoint x = sum.vertex(t);
        for (std::size_t k = 0; k < 2; ++k) size = std::max({size, std::abs(x.p[k]), std::abs(x.q[k])});
        rough.corners[static_cast<std::size_t>(t)] = rounded(x);
      }
    }
    // Corners err by 2u times the size, sides are products of lengths of four sizes at most.
    constexpr double kAir = 0x1p-44;
    const bool in_range = size > 0x1p-400 && size < 0x1p400;
    air_ = in_range ? kAir * size * size : std::numeric_limits<double>::infinity();
  }

  static Point2 rounded(const SumPoint& x) { return {x.p[0] - x.q[0], x.p[1] - x.q[1]}; }

  /// Where the segment from s to z (rounded as above) lies: in the interior of the sum; with no point in common with
  /// it; or neither for certain.
  [[nodiscard]] Where place(std::int32_t sum, const Point2& s, const Point2& z) const {
    const Rough& rough = rough_[static_cast<std::size_t>(sum)];
    bool holds = true;
    double least = std::numeric_limits<double>::infinity(), greatest = -least;
    for (std::size_t t = 0; t < static_cast<std::size_t>(rough.count); ++t) {
      const Point2& a = rough.corners[t];
      const Point2& b = rough.corners[t + 1 == static_cast<std::size_t>(rough.count) ? 0 : t + 1];
      const double of_s = side(a, b, s), of_z = side(a, b, z);
      if (std::max(of_s, of_z) < -air_) return Where::apart;
      holds = holds && std::min(of_s, of_z) > air_;
      const double of_corner = side(s, z, a);
      least = std::min(least, of_corner);
      greatest = std::max(greatest, of_corner);
    }
    if (least > air_ || greatest < -air_) return Where::apart;
    return holds ? Where::holds : Where::unclear;
  }

 private:
  struct Rough {
    std::array<Point2, 6> corners{};
    int count = 0;
  };
  /// > 0 where x lies to the left of the line from a to b.
  static double side(const Point2& a, const Point2& b, const Point2& x) {
    return (b[0] - a[0]) * (x[1] - a[1]) - (b[1] - a[1]) * (x[0] - a[0]);
  }

  std::vector<Rough> rough_;
  double air_ = 0;
};

}  // namespace pd::detail
