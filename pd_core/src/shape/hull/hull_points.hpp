/// @file
/// The points that a hull is built from: scaled copies for the filters, the caller's numbers for what the filters
/// leave.
///
/// Scaling is by a power of two that brings the largest |coordinate| into [1/2, 1) (or as near as doubles allow for
/// numbers below 1e-301). It is exact unless the magnitudes of one body span more than about 2^1000; then exact
/// decisions are made on the caller's numbers.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pd/numeric/predicates.hpp"
#include "pd/numeric/vector.hpp"

namespace pd::detail {

/// 32 bytes, so that one point is one half of a cache line.
struct HullPoint {
  double x, y, z;     ///< scaled
  std::int32_t id;    ///< index into the caller's points
  std::int32_t next;  ///< next point outside the same facet (`Quickhull`)
};

class HullPoints {
 public:
  /// Refers to `source`, which must outlive it. @param max_abs  the largest |coordinate|.
  HullPoints(std::span<const Vec3> source, double max_abs);

  void reserve(std::size_t n) { points_.reserve(n); }
  /// Adds the caller's point `id`.
  void append(std::int32_t id);
  /// Puts the points from index `first` on in Morton order, so that points near in space are near in memory. Stable.
  void sort_spatially(int first);

  [[nodiscard]] int size() const { return static_cast<int>(points_.size()); }
  [[nodiscard]] double scale() const { return scale_; }
  [[nodiscard]] bool scaling_exact() const { return scaling_exact_; }
  [[nodiscard]] HullPoint& operator[](int i) { return points_[static_cast<std::size_t>(i)]; }
  [[nodiscard]] const HullPoint& operator[](int i) const { return points_[static_cast<std::size_t>(i)]; }

  /// The caller's numbers, with -0 as +0.
  [[nodiscard]] Vec3 original(int i) const { return source_[static_cast<std::size_t>((*this)[i].id)] + Vec3::Zero(); }

  /// Lexicographic by x, y, z; the lower caller id where the points are equal.
  [[nodiscard]] bool less(int i, int j) const;
  [[nodiscard]] bool equal(int i, int j) const;

  /// `pd::orient3d` of four points.
  [[nodiscard]] int orient3d(int a, int b, int c, int d) const;
  /// `pd::orient2d` of three points seen along `axis` (0: (y, z), 1: (z, x), 2: (x, y)).
  [[nodiscard]] int orient2d(int a, int b, int c, int axis) const;
  [[nodiscard]] bool collinear(int a, int b, int c) const;

 private:
  /// What exact decisions are made on: the scaled numbers where they are exact (expansions stay in range).
  [[nodiscard]] Vec3 decisive(int i) const {
    const HullPoint& p = (*this)[i];
    return scaling_exact_ ? Vec3(p.x, p.y, p.z) : original(i);
  }

  std::span<const Vec3> source_;
  double scale_ = 1;
  double unscale_ = 1;
  bool scaling_exact_ = true;
  std::vector<HullPoint> points_;
};

}  // namespace pd::detail
