/// @file
/// Convex sums in doubles: which part of a candidate a sum covers for certain, and which it cannot reach. Most
/// candidates are covered for certain by a few sums. Only the rest take exact signs, and only of sums near the rest.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "planar/boundary/convex_sum.hpp"

namespace pd::detail {

/// A sum's share of a segment, by fractions of the segment's length.
struct RoughCover {
  std::int32_t sum = -1;
  /// For certain in the sum's interior; empty where `inner_from` > `inner_to`.
  double inner_from = 0, inner_to = 1;
  /// Everything outside of this interval is for certain not in the closed sum.
  double outer_from = 0, outer_to = 1;

  [[nodiscard]] bool whole() const { return inner_from <= 0 && inner_to >= 1; }
};

class RoughSums {
 public:
  explicit RoughSums(const std::vector<ConvexSum>& sums) {
    double size = 0;
    first_.reserve(sums.size() + 1);
    for (const ConvexSum& sum : sums) {
      first_.push_back(corners_.size());
      for (int t = 0; t < sum.size(); ++t) {
        if (compare_angles(sum.direction(t == 0 ? sum.size() - 1 : t - 1), sum.direction(t)) == 0) continue;
        const SumPoint x = sum.vertex(t);
        for (std::size_t k = 0; k < 2; ++k) size = std::max({size, std::abs(x.p[k]), std::abs(x.q[k])});
        corners_.push_back(rounded(x));
      }
    }
    first_.push_back(corners_.size());
    // Corners err by 2u times the size. Sides are two products of lengths of four sizes at most, and err by 2^7 u
    // size^2. Fractions err by 3u times a difference of two sides: by 2^7 u size^2 along the edge's normal.
    constexpr double kAir = 0x1p-43;
    in_range_ = size > 0x1p-400 && size < 0x1p400;
    air_ = kAir * size * size;
  }

  static Point2 rounded(const SumPoint& x) { return {x.p[0] - x.q[0], x.p[1] - x.q[1]}; }

  /// The share of the segment from s to z (rounded as above). @return false if the two have for certain no point in
  /// common. Where squares of the coordinates overflow or underflow nothing is certain: every sum may reach the
  /// segment.
  [[nodiscard]] bool cover(std::int32_t sum, const Point2& s, const Point2& z, RoughCover& r) const {
    r = {.sum = sum};
    if (!in_range_) {
      r.inner_to = -1;
      return true;
    }
    const std::size_t begin = first_[static_cast<std::size_t>(sum)], end = first_[static_cast<std::size_t>(sum) + 1];
    double least = std::numeric_limits<double>::infinity(), greatest = -least;
    const Point2* a = &corners_[end - 1];
    for (std::size_t t = begin; t < end; ++t) {
      const Point2& b = corners_[t];
      const double at_s = side(*a, b, s), at_z = side(*a, b, z), rise = at_z - at_s;
      if (std::max(at_s, at_z) < -air_) return false;
      if (std::max(at_s, at_z) <= air_) {
        r.inner_to = -1;
      } else if (at_s <= air_) {
        r.inner_from = std::max(r.inner_from, (air_ - at_s) / rise);
      } else if (at_z <= air_) {
        r.inner_to = std::min(r.inner_to, (air_ - at_s) / rise);
      }
      if (at_s < -air_) {
        r.outer_from = std::max(r.outer_from, (-air_ - at_s) / rise);
      } else if (at_z < -air_) {
        r.outer_to = std::min(r.outer_to, (-air_ - at_s) / rise);
      }
      const double of_corner = side(s, z, b);
      least = std::min(least, of_corner);
      greatest = std::max(greatest, of_corner);
      a = &b;
    }
    return least <= air_ && greatest >= -air_ && r.outer_from <= r.outer_to;
  }

 private:
  /// > 0 where x lies to the left of the line from a to b.
  static double side(const Point2& a, const Point2& b, const Point2& x) {
    return (b[0] - a[0]) * (x[1] - a[1]) - (b[1] - a[1]) * (x[0] - a[0]);
  }

  std::vector<Point2> corners_;
  std::vector<std::size_t> first_;  ///< by sum, one more at the end: into `corners_`
  double air_ = 0;
  bool in_range_ = false;
};

/// Finds the sums that must be intersected with a candidate exactly.
class RoughUnion {
 public:
  void clear() { shares_.clear(); }
  void add(const RoughCover& share) { shares_.push_back(share); }
  [[nodiscard]] std::size_t size() const { return shares_.size(); }

  /// True if the shares cover the candidate for certain. If not, `needed` holds the sums that reach one of the gaps and
  /// those of the chain between the gaps: every other sum adds nothing to the union.
  [[nodiscard]] bool whole(std::vector<std::int32_t>& needed) {
    std::sort(shares_.begin(), shares_.end(), [](const RoughCover& a, const RoughCover& b) {
      return a.inner_from != b.inner_from ? a.inner_from < b.inner_from : a.sum < b.sum;
    });
    gaps_.clear();
    needed.clear();
    double reach = 0;
    std::size_t next = 0;
    const auto begins = [&](double from) { return next < shares_.size() && shares_[next].inner_from <= from; };
    while (reach < 1) {
      double farthest = reach;
      std::int32_t best = -1;
      for (; begins(reach); ++next) {
        if (shares_[next].inner_to <= farthest) continue;
        farthest = shares_[next].inner_to;
        best = shares_[next].sum;
      }
      if (best >= 0) {
        needed.push_back(best);
        reach = farthest;
        continue;
      }
      while (next < shares_.size() && shares_[next].inner_to <= shares_[next].inner_from) ++next;
      const double until = next < shares_.size() ? std::min(1.0, shares_[next].inner_from) : 1;
      gaps_.push_back({reach, until});
      reach = until;
    }
    if (gaps_.empty()) return true;
    for (const RoughCover& share : shares_) {
      const bool reaches = std::any_of(gaps_.begin(), gaps_.end(), [&](const Gap& gap) {
        return share.outer_from <= gap.to && share.outer_to >= gap.from;
      });
      if (reaches) needed.push_back(share.sum);
    }
    std::sort(needed.begin(), needed.end());
    needed.erase(std::unique(needed.begin(), needed.end()), needed.end());
    return false;
  }

 private:
  struct Gap {
    double from, to;
  };
  std::vector<RoughCover> shares_;
  std::vector<Gap> gaps_;
};

}  // namespace pd::detail
