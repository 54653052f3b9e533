/// @file
/// The rounded determinants of orient2d and orient3d and the bounds of their errors: the filters of the predicates.
///
/// [S] Shewchuk, "Adaptive precision floating-point arithmetic and fast robust geometric predicates", 1997.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "numeric/double_double.hpp"
#include "numeric/unit_roundoff.hpp"
#include "pd/numeric/vector.hpp"

namespace pd::detail {

// (3 + 16u)u and (7 + 56u)u times the permanent ([S] section 4.2 and 4.3, u = 2^-53), rounded up to cover the roundings
// of bound and permanent themselves. kFilterUnderflow covers what underflows while every difference is at most
// kLargestFiltered: at most 2^-1074 for a product, times a third factor, and a few of them.
// Largest error / bound that `bound_ratios` found: 0.709 in the plane and 0.707 in space, where a last rounding, which
// leaves the sign alone, is not counted.
inline constexpr double kBound2d = 4 * kUnitRoundoff;
inline constexpr double kBound3d = 8 * kUnitRoundoff;
inline constexpr double kFilterUnderflow = 0x1p-700;
inline constexpr double kLargestFiltered = 0x1p330;
// Differences are exact in double-double. Two levels of products (5u^2 each) and three of sums (3u^2 each) on
// magnitudes that the permanent bounds give 19u^2(1 + O(u)) of it; the bound leaves room for the permanent's own
// rounding. Largest error / bound found: 0.173.
inline constexpr double kBoundDoubleDouble = 32 * 0x1p-106;
// Coordinates that come here are at least 2^-300 or 0, and their differences at least 2^-352: what underflows is below
// 2^-1074 times differences below 2^322, a few times.
inline constexpr double kTinyDoubleDouble = 0x1p-740;

/// det(b - a, c - a), off by at most `error` (false where something overflows: then so does `error`).
struct RoundedOrient2d {
  double determinant;
  double error;
};
[[nodiscard]] inline RoundedOrient2d rounded_orient2d(const std::array<double, 2>& a, const std::array<double, 2>& b,
                                                      const std::array<double, 2>& c) {
  const double bx = b[0] - a[0];
  const double by = b[1] - a[1];
  const double cx = c[0] - a[0];
  const double cy = c[1] - a[1];
  const double left = bx * cy;
  const double right = by * cx;
  return {left - right, kBound2d * (std::abs(left) + std::abs(right)) + kFilterUnderflow};
}

/// det(b - a, c - a, d - a), off by at most `error` where `in_range`.
struct RoundedOrient3d {
  double determinant;
  double permanent;
  double largest;  ///< difference of two coordinates

  [[nodiscard]] double error() const { return kBound3d * permanent + kFilterUnderflow; }
  [[nodiscard]] bool in_range() const { return largest <= kLargestFiltered; }
  /// Of the determinant in double-double.
  [[nodiscard]] double double_double_error() const { return kBoundDoubleDouble * permanent + kTinyDoubleDouble; }
};
[[nodiscard]] inline RoundedOrient3d rounded_orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const double bx = b.x() - a.x();
  const double by = b.y() - a.y();
  const double bz = b.z() - a.z();
  const double cx = c.x() - a.x();
  const double cy = c.y() - a.y();
  const double cz = c.z() - a.z();
  const double dx = d.x() - a.x();
  const double dy = d.y() - a.y();
  const double dz = d.z() - a.z();
  const double by_cz = by * cz;
  const double bz_cy = bz * cy;
  const double bz_cx = bz * cx;
  const double bx_cz = bx * cz;
  const double bx_cy = bx * cy;
  const double by_cx = by * cx;
  return {dx * (by_cz - bz_cy) + dy * (bz_cx - bx_cz) + dz * (bx_cy - by_cx),
          std::abs(dx) * (std::abs(by_cz) + std::abs(bz_cy)) + std::abs(dy) * (std::abs(bz_cx) + std::abs(bx_cz)) +
              std::abs(dz) * (std::abs(bx_cy) + std::abs(by_cx)),
          std::max(std::abs(dx), std::max(std::abs(dy), std::abs(dz)))};
}

/// The same determinant, its differences exact and its products and sums in double-double. The sum is normalised: its
/// high part has its sign.
[[nodiscard]] inline DoubleDouble double_double_orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const auto from_a = [&](const Vec3& p) {
    return Vec3DD{two_sum(p.x(), -a.x()), two_sum(p.y(), -a.y()), two_sum(p.z(), -a.z())};
  };
  return dot(from_a(d), cross(from_a(b), from_a(c)));
}

}  // namespace pd::detail
