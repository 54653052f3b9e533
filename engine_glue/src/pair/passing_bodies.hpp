/// @file
/// Bodies that meet on an edge alone, and pass each other there.
///
/// If two edges lie along each other, the bodies are apart along several directions, and the direction of the
/// nearest points is no more than rounding. Points along it stop a body that falls into a notch of its own width at the
/// rim, on edges that it does not meet. If the bodies are apart along the normal of a facet, and stay so in this step,
/// they do not touch in it, whatever they do along other directions. One of the bodies must be static or kinematic: in
/// a heap that lands, boxes that meet edge to edge carry loads of others.
#pragma once

#include "pair/manifold_points.hpp"
#include "pair/step_reach.hpp"
#include "pd/shape/convex_shape.hpp"

namespace pd::detail {

/// A strip is an edge if its width is at most this share of the breaking threshold.
inline constexpr btScalar kEdge = btScalar(0x1p-12);

/// True if there are points, and all lie in a strip of about this width. Two points always do. Time O(1).
[[nodiscard]] bool on_one_line(const FreshPoints& points, btScalar width);

/// True if points of two bodies would push in this step although the bodies stay apart along the normal of a facet, up
/// to the slack of pieces that are meant to meet (`seam_slack`). Smooth bodies have no facets. Time: a support of both
/// bodies for each facet.
[[nodiscard]] bool pass_each_other(const PosedShape& a, const PosedShape& b, const FreshPoints& points,
                                   const StepReach& step);

}  // namespace pd::detail
