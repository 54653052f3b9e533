/// @file
/// The surface of a Minkowski difference for the eye: any choice of its facets, each in a colour of its own.
#pragma once

#include <functional>

#include "pd/depth/minkowski_difference.hpp"
#include "pd/render/mesh.hpp"

namespace pd::demo {

/// The kind's colour: facet of A, facet of B, edge against edge.
[[nodiscard]] render::Colour colour_of(DifferenceFacetKind kind);

/// The facets that `wanted` names, coloured by `colour` (an empty function: by kind); edges between facets that meet at
/// more than 10 degrees are inked, and those to facets that are left out.
[[nodiscard]] render::MeshRef difference_mesh(const MinkowskiDifference& p,
                                              const std::function<bool(std::size_t facet)>& wanted,
                                              const std::function<render::Colour(std::size_t facet)>& colour = {});

}  // namespace pd::demo
