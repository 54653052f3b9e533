/// @file
/// The depth of two solids that overlap.
#pragma once

#include "pd/solid/solid_depth.hpp"
#include "solid/posed_solids.hpp"

namespace pd::detail {

struct OverlapQuestion {
  const PosedSolid& a;
  const PosedSolid& b;
  const PosedSolids& solids;
  const SolidSettings& settings;
};

/// Requires overlapping solids. Fills class, bracket, translation, normal and witnesses.
///
/// The hulls give a first translation. The solids' convex parts narrow the bracket, first exact ones, then coarser ones
/// where those are too many. Vertices that lie deep in the other solid raise what is left of it from below.
void set_depth(const OverlapQuestion& question, Scratch& scratch, SolidDepth& out);

}  // namespace pd::detail
