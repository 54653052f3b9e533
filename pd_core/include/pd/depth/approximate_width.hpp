/// @file
/// The width of many points within (1 + delta), without their convex hull: [A] Corollary 3.4 of the earlier version, by
/// a small kernel.
///
/// The paper fattens the points by an affine map, takes an O(1 / delta) approximation of the fat set, and works on
/// that. Departure: its approximation needs a nearest-point search a sample, or O(1 / delta^2) directions where extreme
/// points alone are to be guaranteed. Here a pass takes the extreme points of the fattened set along a grid of about
/// 0.6 / delta directions. The kernel's exact width is the lower bound. The extents of all points along the kernel's
/// thinnest normals, a few at a time, are the upper one. Points that those passes meet join the kernel, until the two
/// bounds agree. The result is certified whatever the points are; the number of passes is measured, not proved.
///
/// [A] Agarwal, Guibas, Har-Peled, Rabinovitch, Sharir, "Penetration depth of two convex polytopes in 3D", 2000.
#pragma once

#include <cstdint>
#include <span>

#include "pd/numeric/expected.hpp"
#include "pd/numeric/vector.hpp"

namespace pd {

class Scratch;

struct ApproximateWidth {
  double width = 0;  ///< = upper
  double lower = 0;  ///< exact width of the kernel, rounded down: lower <= width of the points <= upper
  double upper = 0;  ///< extent of all points along `normal`, rounded up; <= (1 + delta) lower but for rounding
  Vec3 normal = Vec3::UnitX();
  std::int64_t kernel_size = 0;             ///< points of the kernel's hull
  std::int64_t passes = 0;                  ///< over all points
  std::int64_t dot_products_per_point = 0;  ///< in all passes together
};

/// Width of the convex hull of n points.
///
/// upper <= (1 + delta) lower, except where rounding (2^-48 of the largest coordinate) is more than that: flat sets and
/// sets far from the origin.
///
/// @param points  [n x 3], n >= 1, finite, |coordinate| <= 1e150.
/// @param delta   in (0, 1], at least 1e-6.
/// @return ErrorCode::too_few_points, non_finite, out_of_range ("points[i]"), bad_value or limit_exceeded ("delta").
/// Time: `dot_products_per_point` products a point, and the work on kernels of O(1 / delta) points, which does not
/// depend on n. Measured for delta = 1e-2: about 190 products on a sphere, the worst case met, and 75 to 85 on
/// flattened spheres, cubes and needles.
[[nodiscard]] Expected<ApproximateWidth> approximate_width(std::span<const Vec3> points, double delta,
                                                           Scratch& scratch);

}  // namespace pd
