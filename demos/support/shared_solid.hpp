/// @file
/// The solid that two posed polytopes share, for drawing.
#pragma once

#include <optional>

#include "pd/shape/convex_polytope.hpp"
#include "pd/shape/pose.hpp"

namespace pd::demo {

/// A and B's common solid in the common frame, in doubles: hull of the vertices of each inside the other and of the
/// points where edges of one cross facets of the other. Nothing where there is none or it is flat.
///
/// Time O(m n). Good to rounding for pictures; no figure may rest on it.
[[nodiscard]] std::optional<ConvexPolytope> shared_solid(const ConvexPolytope& a, const Pose& pose_a,
                                                         const ConvexPolytope& b, const Pose& pose_b);

}  // namespace pd::demo
