/// @file
/// The class of two polytopes without their margins, for engines that need the cores to overlap before they begin ([A]
/// tests disjointness first).
#pragma once

#include "depth/pair/polytope_depth.hpp"

namespace pd::detail {

/// The exact class and a coarse depth (a bracket within a factor of two) of the cores.
[[nodiscard]] inline PenetrationDepth coarse_core_depth(const PolytopePair& pair, ScratchBuffers& buffers) {
  DepthSettings coarse;
  coarse.delta = 1;
  PenetrationDepth cores;
  polytope_depth({pair.a, pair.b, pair.pose_a, pair.pose_b, {}}, coarse, buffers, nullptr, cores);
  return cores;
}

}  // namespace pd::detail
