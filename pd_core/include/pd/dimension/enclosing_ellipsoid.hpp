/// @file
/// The minimum enclosing ellipsoid of points, approximately, with a certified sandwich ([M] Lemma 6).
///
/// Let weights u >= 0 with sum 1 give the points mean c and covariance S, and let R^2 = max (p - c)^T S^-1 (p - c).
/// The ellipsoid {(x - c)^T S^-1 (x - c) <= R^2} holds all points, and the hull of the points holds its image shrunk
/// by R^2. Along any v the centred points have variance s^2 = v^T S v. Their extents a, b along v obey a b >= s^2
/// (Bhatia and Davis). From a <= R s follows b >= s / R. So ratio = R^2, certified for any weights; the optimal ones
/// have R^2 = d (Khachiyan's problem). Weights: Khachiyan's coordinate ascent with the away steps of Todd and Yildirim,
/// on a core set that takes in the farthest points of each pass.
///
/// [TY] Todd, Yildirim, "On Khachiyan's algorithm for the computation of minimum-volume enclosing ellipsoids", 2007.
#pragma once

#include <cstdint>
#include <span>

#include "pd/dimension/sandwich.hpp"
#include "pd/numeric/expected.hpp"

namespace pd::dimension {

template <int D>
struct EnclosingEllipsoid {
  /// C of the sandwich is the inner ellipsoid; the enclosing one is its `ratio`-expansion. ratio <= d (1 + eta).
  Sandwich<D> sandwich;
  std::int64_t passes = 0;     ///< over all points
  std::int64_t core_size = 0;  ///< points that carry weights
  std::int64_t steps = 0;      ///< of the ascent
};

/// @param points  [n x D], n > D, finite, |coordinate| <= kMaxCoordinate.
/// @param eta     in [1e-7, 1].
/// @return ErrorCode::too_few_points, non_finite, out_of_range ("points[i]"), not_full_dimensional, bad_value ("eta").
/// Volume: at most (1 + eta)^d of the minimum's. O(n) time a pass; passes are measured, not bounded by theory.
template <int D>
[[nodiscard]] Expected<EnclosingEllipsoid<D>> enclosing_ellipsoid(std::span<const Vector<D>> points, double eta);

}  // namespace pd::dimension
