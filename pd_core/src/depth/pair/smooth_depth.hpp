/// @file
/// Depth and distance where at least one core is smooth: (1 + delta), certified in doubles.
#pragma once

#include "depth/pair/scratch_buffers.hpp"
#include "pd/depth/depth_answer.hpp"
#include "pd/shape/convex_shape.hpp"

namespace pd {
class WarmCertificate;
}

namespace pd::detail {

/// Expansion over analytic supports, stopped at upper <= (1 + delta) lower or upper - lower <= 1e-12 L; no curved shape
/// is tessellated.
///
/// Sizes far from 1 are scaled by a power of two first. Balls that roll inside the cores are taken out of them and
/// added to the margins, but for contacts (Rolling). A point or ball in an ellipsoid has a closed form; bodies that
/// nearly have one distance in all directions are answered from the balls in them. Else a search may end after
/// kMaxSmoothSteps supports with the bracket reached so far (`bracket_reached` false): some 20 to 70 ms.
///
/// It ends: each step either adds a support that rises above the nearest face by more than rounding, and strictly
/// convex pieces then halve the face's angle, or finds the face within rounding of the surface. Where rounding folds
/// the surface before the bracket is reached, the search starts again from another direction; the narrowest certified
/// bracket stands.
///
/// @param warm  where cores are apart, the points round the last nearest one are where the next search begins.
void smooth_depth(const PosedShape& a, const PosedShape& b, const DepthSettings& settings, ScratchBuffers& buffers,
                  PenetrationDepth& out, WarmCertificate* warm = nullptr);

}  // namespace pd::detail
