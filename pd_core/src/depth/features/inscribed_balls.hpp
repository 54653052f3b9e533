/// @file
/// The depth of two smooth cores from the balls inscribed in them: at once where all directions are nearly tied, which
/// an expansion can only answer by covering the sphere (two concentric balls, a thin cylinder in another one).
#pragma once

#include <optional>

#include "depth/difference/smooth_difference.hpp"

namespace pd::detail {

/// A certified bracket of the depth of the difference that was asked, and the points of the cores, or of the balls in
/// them, that face each other across it.
struct InscribedBallsDepth {
  double lower = 0;
  double upper = 0;
  Vec3 normal = Vec3::UnitX();  ///< unit; h_P(normal) <= upper
  Vec3 on_a = Vec3::Zero();     ///< relative to the translation of A
  Vec3 on_b = Vec3::Zero();
};

/// P holds the ball of radius r_a + r_b about c_b - c_a, so that the depth is at least r_a + r_b - |c_b - c_a|; it is
/// at most h_P(n) for every n, tried along both bodies' axes, across their axes of revolution, and along c_b - c_a.
/// Nothing where a core has no ball at hand (polytopes other than points) or the balls do not hold the origin.
/// What the difference has taken out of the cores is taken off the balls. Time: at most eighteen supports.
[[nodiscard]] std::optional<InscribedBallsDepth> inscribed_balls_depth(const PosedShape& a, const PosedShape& b,
                                                                       const SmoothDifference& difference,
                                                                       std::int64_t& support_calls);

/// Of an ellipsoid, cylinder or cone and the ball in a point, or in an ellipsoid that is nearly one: the ball's radius
/// and the depth of its centre in the other core (point_in_ellipsoid.hpp, point_in_revolution.hpp). Exact but for
/// rounding where the ball is all of its core. Nothing for other cores, or where the centre lies outside.
[[nodiscard]] std::optional<InscribedBallsDepth> ball_in_core_depth(const PosedShape& a, const PosedShape& b,
                                                                    const SmoothDifference& difference,
                                                                    std::int64_t& support_calls);

}  // namespace pd::detail
