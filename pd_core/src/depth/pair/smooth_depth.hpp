/// @file
/// Depth and distance where at least one core is smooth: (1 + delta), certified in doubles.
#pragma once

#include "depth/pair/scratch_buffers.hpp"
#include "pd/depth/penetration_depth.hpp"

namespace pd::detail {

/// Expansion over analytic supports, stopped at upper <= (1 + delta) lower or upper - lower <= 1e-12 L; no curved shape
/// is tessellated.
///
/// It ends: each step either adds a support that rises above the nearest face by more than rounding, and strictly
/// convex pieces then halve the face's angle, or finds the face within rounding of the surface. Where rounding folds
/// the surface before the bracket is reached, the search starts again from another direction; the narrowest certified
/// bracket stands.
void smooth_depth(const PosedShape& a, const PosedShape& b, const DepthSettings& settings, ScratchBuffers& buffers,
                  PenetrationDepth& out);

}  // namespace pd::detail
