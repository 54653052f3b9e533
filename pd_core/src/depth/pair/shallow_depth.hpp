/// @file
/// [A] Shallow-Penetration as an engine: rays, then the facets inside a ball (`shallow_facets.hpp`).
#pragma once

#include "depth/pair/polytope_depth.hpp"
#include "pd/depth/depth_answer.hpp"
#include "pd/structure/direction_grid.hpp"

namespace pd::detail {

/// delta where none is given: few rays, and a ball by an eighth larger than the depth.
inline constexpr double kDefaultShallowDelta = 0.25;
/// Some 2,800 rays, which take a tenth of a second for 64 vertices.
inline constexpr double kLeastShallowDelta = 0x1p-8;

/// @param grid  of covering radius arccos(1 / (1 + delta / 4)).
[[gnu::cold]] void shallow_depth(const PolytopePair& pair, double delta, const DirectionGrid& grid,
                                 const DepthSettings& settings, ScratchBuffers& buffers, PenetrationDepth& out,
                                 ShallowCounts& counts);

}  // namespace pd::detail
