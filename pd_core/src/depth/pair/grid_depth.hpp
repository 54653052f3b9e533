/// @file
/// [A] Approx-Separation as an engine: rays along an adaptively refined covering of the sphere
/// (`direction_refinement.hpp`).
#pragma once

#include "depth/pair/polytope_depth.hpp"
#include "depth/rays/direction_refinement.hpp"
#include "pd/shape/convex_shape.hpp"

namespace pd::detail {

/// delta where none is given.
inline constexpr double kDefaultGridDelta = 1e-2;

/// Depth of any two convex bodies: upper <= (1 + delta) lower with delta = max(settings.delta, 1e-12), rounding's
/// share. For smooth bodies a bracket 1e-12 L wide is enough, too.
///
/// Class, distance and touching come from the expansion ([A] tests disjointness first, by linear programming). Bodies
/// that overlap by their margins alone are answered exactly: their cores' distance decides.
void grid_depth(const PosedShape& a, const PosedShape& b, const DepthSettings& settings, ScratchBuffers& buffers,
                PenetrationDepth& out);

}  // namespace pd::detail
