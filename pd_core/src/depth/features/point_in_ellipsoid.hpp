/// @file
/// The depth of a point in an ellipsoid in closed form, up to one root of a rational function.
#pragma once

#include "pd/numeric/vector.hpp"

namespace pd::detail {

/// Both in the ellipsoid's frame.
struct PointInEllipsoid {
  double lower = 0;  ///< the ball of this radius around the point lies in the ellipsoid; 0: nothing is known
  Vec3 outward = Vec3::UnitX();  ///< from the point to the nearest point of the surface, any length
};

/// By the S-lemma (Yakubovich; Polik and Terlaky, A survey of the S-lemma, 2007) the ball of radius d around p lies in
/// sum x_i^2 / r_i^2 <= 1 exactly if d^2 <= g(m) = m (1 - sum p_i^2 / (r_i^2 - m)) for some m in [0, r_min^2]. Every m
/// gives a lower bound, the largest g the depth itself: Newton's iteration on the secular equation g' = 0, as in
/// trust-region methods (More, Sorensen 1983), whose hard case is a point on the planes across the shortest axes.
/// Requires a point inside.
[[nodiscard]] PointInEllipsoid point_in_ellipsoid(const Vec3& radii, const Vec3& point);

}  // namespace pd::detail
