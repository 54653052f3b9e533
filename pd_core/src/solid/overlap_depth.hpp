/// @file
/// The depth of two solids that overlap.
#pragma once

#include <optional>

#include "pd/solid/solid_depth.hpp"
#include "solid/posed_solids.hpp"

namespace pd::detail {

/// Requires overlapping solids. Fills class, bracket, translation, normal and witnesses.
[[nodiscard]] std::optional<Error> set_depth(const PosedSolid& a, const PosedSolid& b, const PosedSolids& solids,
                                             const SolidSettings& settings, Scratch& scratch, SolidDepth& out);

}  // namespace pd::detail
