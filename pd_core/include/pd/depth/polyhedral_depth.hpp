/// @file
/// Penetration depth under a polyhedral metric: [A] section 3.1, Corollary 3.4.
///
/// The unit ball is any convex polytope Q with the origin inside, symmetric or not; the length of t is its gauge, the
/// least lambda with t in lambda Q. The largest lambda Q inside P = B + (-A) touches the boundary of P with a vertex,
/// and its vertices move on rays from the origin. So one ray is shot for each vertex of Q, and the least lambda
/// counts.
///
/// [A] Agarwal, Guibas, Har-Peled, Rabinovitch, Sharir, "Penetration depth of two convex polytopes in 3D", 2000.
#pragma once

#include "pd/depth/penetration_depth.hpp"
#include "pd/numeric/expected.hpp"
#include "pd/shape/convex_polytope.hpp"

namespace pd {

class Scratch;

/// The least lambda for which some translation in lambda Q separates two posed polytopes, exact on the stored numbers
/// and poses.
///
/// The answer is that of `penetration_depth`, except where the bodies overlap. There depth, lower and upper are
/// lambda (neighbouring doubles, or equal). The translation is lambda times a vertex of Q, rounded outwards so that
/// it separates exactly as stored; its gauge exceeds lambda by some ulps. The normal is its unit vector. Where they do
/// not, distances are Euclidean.
///
/// @param unit_ball  Q, in the frame that A and B share.
/// @return ErrorCode::not_full_dimensional or bad_value ("metric") when the origin is not inside Q; unsupported when a
/// shape is smooth or has a margin.
/// Time O(m + n) for the class, and one portal search a vertex of Q (the paper's ray in two hierarchies).
[[nodiscard]] Expected<PenetrationDepth> polyhedral_depth(const PosedShape& a, const PosedShape& b,
                                                          const ConvexPolytope& unit_ball, Scratch& scratch);

}  // namespace pd
