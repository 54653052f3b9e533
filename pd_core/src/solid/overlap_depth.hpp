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
/// The hulls give a first translation. Where the solids have few convex parts, these give the depth; else a cover of
/// the translations about zero (translation_cover.hpp) narrows the bracket.
void set_depth(const OverlapQuestion& question, Scratch& scratch, SolidDepth& out);

class ShapeBeside;

/// Asks a solid and a convex shape likewise: the hull, then the parts of the solid, then the cover.
void set_depth_beside(const PosedSolid& a, const PosedShape& b, ShapeBeside& beside, const SolidSettings& settings,
                      Scratch& scratch, SolidDepth& out);

}  // namespace pd::detail
