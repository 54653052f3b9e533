/// @file
/// Tells which face, edge or corner of a box a segment is nearest to, wherever along the segment.
///
/// In the box's own coordinates the squared distance of a point of the segment is a convex function of its place t,
/// made of parabolas. Where it is least, the coordinates that lie outside the box's extent name the face, the edge or
/// the corner.
#pragma once

#include <cstdlib>

#include "pd/numeric/vector.hpp"

namespace pd::detail {

/// Holds the side of the box that each coordinate lies beyond, 0 within.
struct SidesOfBox {
  int of[3];
  bool operator==(const SidesOfBox&) const = default;
  [[nodiscard]] int outside() const { return std::abs(of[0]) + std::abs(of[1]) + std::abs(of[2]); }
};

/// A segment in a box's own coordinates.
class SegmentBesideBox {
 public:
  SegmentBesideBox(const Vec3& start, const Vec3& along, const Vec3& halves)
      : start_(start), along_(along), halves_(halves) {}

  [[nodiscard]] Vec3 at(double t) const { return start_ + t * along_; }
  [[nodiscard]] const Vec3& halves() const { return halves_; }
  /// Those of the point nearest to the box.
  [[nodiscard]] SidesOfBox nearest() const {
    SidesOfBox sides = sides_at(0);
    if (slope(0, sides) >= 0) return sides;
    sides = sides_at(1);
    if (slope(1, sides) <= 0) return sides;
    // The slope grows with t along a polygon of at most seven pieces: Newton's step is right once on the right one.
    double low = 0, high = 1, t = 0.5;
    for (int step = 0; step < kMostSteps; ++step) {
      sides = sides_at(t);
      const double here = slope(t, sides);
      (here < 0 ? low : high) = t;
      double growth = 0;
      for (int k = 0; k < 3; ++k) growth += sides.of[k] == 0 ? 0 : along_[k] * along_[k];
      const double next = t - here / growth;
      if (!(next > low && next < high)) {
        if (!(growth > 0) || next == t) return sides;
        t = 0.5 * (low + high);
        continue;
      }
      t = next;
      if (sides_at(t) == sides) return sides;
    }
    return sides;
  }

 private:
  static constexpr int kMostSteps = 24;

  [[nodiscard]] SidesOfBox sides_at(double t) const {
    SidesOfBox sides{};
    for (int k = 0; k < 3; ++k) {
      const double x = start_[k] + t * along_[k];
      sides.of[k] = (x > halves_[k] ? 1 : 0) - (x < -halves_[k] ? 1 : 0);
    }
    return sides;
  }
  /// Half of the squared distance's derivative.
  [[nodiscard]] double slope(double t, const SidesOfBox& sides) const {
    double sum = 0;
    for (int k = 0; k < 3; ++k) {
      if (sides.of[k] != 0) sum += (start_[k] + t * along_[k] - sides.of[k] * halves_[k]) * along_[k];
    }
    return sum;
  }

  Vec3 start_;
  Vec3 along_;
  Vec3 halves_;
};

}  // namespace pd::detail
