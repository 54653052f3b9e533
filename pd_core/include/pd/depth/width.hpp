/// @file
/// The width of a convex body: the least distance of two parallel planes that hold it between them.
///
/// width(P) = pi(P, P) ([A] Proposition 2.1), so that every exact depth engine computes it.
#pragma once

#include "pd/depth/penetration_depth.hpp"
#include "pd/shape/convex_shape.hpp"

namespace pd {

class Scratch;

struct Width {
  double width = 0;
  double lower = 0;  ///< lower <= exact width <= upper; neighbouring doubles (or equal)
  double upper = 0;
  Vec3 normal = Vec3::UnitX();  ///< unit normal of the two planes, in the common frame
  Statistics statistics;
};

/// Width of a posed body. Flat bodies have width 0 (plus twice the margin of a swept body).
///
/// Polytopes, swept or not: exact on the stored numbers and pose. Ellipsoid, cylinder and cone: from their formula,
/// posed by the nearest rotation; for a cone of height H and base radius r, the lesser of H and 2 r H / sqrt(H^2 +
/// r^2).
///
/// @param method  automatic or overlay (every facet of P + (-P): O(m + K)), or expansion.
/// Requires one of those methods.
[[nodiscard]] Width width(const PosedShape& body, Scratch& scratch, Method method = Method::automatic);

}  // namespace pd
