/// @file
/// A local minimum of the height of a curved P over directions, with a cone around it in which no height is less.
///
/// An expanding polytope has to follow curved surfaces by halves: twenty points for an edge on a rim. But near its
/// nearest face everything is known in closed form: each corner belongs to a pair of features (a vertex, rim, apex or
/// sphere of either body), and with those features held fixed the corner is a smooth function x(n) of the direction.
/// Where three pairs meet the nearest plane passes through their points, where two do it holds their edge and turns
/// around it to the least height: Newton's method takes two or three steps.
///
/// The cone. Let n be the unit direction found, y across it, x_i the points, p_i their parts across n. The support
/// function of P is convex, and along n + y at least that of each pair of features,
///     h_i(n + y) >= <x_i, n> + <p_i, y> + (what its roundness adds).
/// Balls of radius b add b (sqrt(1 + y^2) - 1), rims of radius R with unit tangent t at least c <t, y>^2 for |y| <= Y,
/// with c = R / (2 (|q| + Y)), where q is the part of n in the rim's plane and q^ its unit vector:
///     |q + z| = <q^, q + z> + <t, y>^2 / (|q + z| + <q^, q + z>).
/// The origin is a combination of the p_i, so that the greatest of the h_i grows with |y|, across the edge
/// of two points by roundness. Divided by |n + y| = sqrt(1 + y^2) <= 1 + y^2 / 2, it stays at or above <x_i, n> in a
/// cone that follows from comparing coefficients.
#pragma once

#include <optional>

#include "depth/difference/smooth_difference.hpp"

namespace pd::detail {

struct LocalMinimum {
  DifferenceVertex corners[3];  ///< points of P on the plane across `normal`
  double weights[3];            ///< of the origin's foot among them, none below 0; they add up to 1
  Vec3 normal;                  ///< unit
  double lower;                 ///< certified: no height of P in the cone is less
  double upper;                 ///< certified: the height along `normal`
  double cosine;                ///< the cone: all directions whose cosine with `normal` is at least this
};

/// The minimum of the features that the corners of a face of a polytope inside P belong to, if there is one with a cone
/// worth having. Lengths in the unit of the input, directions in the caller's axes.
///
/// @param corners  supports of `difference`. @param normal  the face's, unit, outward.
/// @param relative  `upper` - `lower` is at most about so much of it.
/// @return nothing where a body is an ellipsoid, the corners' features have no minimum nearby, or another is farther
/// out there. Never wrong for that: the caller searches on.
///
/// Time: three or four supports.
[[nodiscard]] std::optional<LocalMinimum> local_minimum(const SmoothDifference& difference,
                                                        const DifferenceVertex (&corners)[3], const Vec3& normal,
                                                        double relative);

}  // namespace pd::detail
