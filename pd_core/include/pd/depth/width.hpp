/// @file
/// The width of a convex body: the least distance of two parallel planes that hold it between them.
///
/// width(P) = pi(P, P) ([A] Proposition 2.1), so that every depth engine computes it. For many points without a hull,
/// see `approximate_width.hpp`.
///
/// [A] Agarwal, Guibas, Har-Peled, Rabinovitch, Sharir, "Penetration depth of two convex polytopes in 3D", 2000.
#pragma once

#include "pd/depth/penetration_depth.hpp"
#include "pd/shape/convex_shape.hpp"

namespace pd {

class Scratch;

struct Width {
  double width = 0;
  /// lower <= exact width <= upper; neighbouring doubles (or equal) but for Method::grid and hulls of spheres.
  double lower = 0;
  double upper = 0;
  /// False: rounding, or the budget, ended a search with upper > (1 + delta) lower; both are certified still.
  bool bracket_reached = true;
  Vec3 normal = Vec3::UnitX();  ///< unit normal of the two planes, in the common frame
  Statistics statistics;
};

/// Width of a posed body. Flat bodies have width 0 (plus twice the margin of a swept body).
///
/// Polytopes, swept or not: exact on the stored numbers and pose. Ellipsoid, cylinder and cone: from their formula,
/// posed by the nearest rotation; for a cone of height H and base radius r, the lesser of H and 2 r H / sqrt(H^2 +
/// r^2). A hull of spheres of unequal radii has no formula: upper <= (1 + delta) lower by `penetration_depth` (delta 0:
/// 1e-6).
///
/// @param method  automatic or overlay (every facet of P + (-P): O(m + K)), expansion, or grid. Grid gives upper <=
/// (1 + delta) lower for polytopes by rays along directions that cover half the sphere, P + (-P) being symmetric ([A]
/// Corollary 3.3, its grid refined where it matters). It shoots 2^14 rays at most, and fewer where they need long
/// numbers.
/// @param delta   for Method::grid, in (0, 1]; 0 means 1e-2.
/// Requires one of those methods.
[[nodiscard]] Width width(const PosedShape& body, Scratch& scratch, Method method = Method::automatic,
                          double delta = 0);

}  // namespace pd
