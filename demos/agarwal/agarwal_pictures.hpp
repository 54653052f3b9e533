/// @file
/// The constructions of [A] as pictures, each of a pair of its own and understandable on its own.
///
/// [A] Agarwal, Guibas, Har-Peled, Rabinovitch, Sharir, "Penetration depth of two convex polytopes in 3D", 2000.
#pragma once

#include "pd/numeric/expected.hpp"
#include "pd/render/renderer.hpp"

namespace pd::demo {

/// Section 2.2: the normal diagrams of -A and B on one sphere; every crossing of two arcs is an edge-edge facet of P,
/// and its colour says which complete bipartite family of the decomposition holds it.
[[nodiscard]] Expected<render::Image> normal_diagrams_picture(render::Renderer& renderer, render::Size size);

/// Section 3, Approx-Separation: a grid of directions that covers the sphere, and the rays shot along it out of P.
[[nodiscard]] Expected<render::Image> direction_grid_picture(render::Renderer& renderer, render::Size size);

/// Section 3, Shallow-Penetration: the facets of P in a ball about the origin, which are all that the search visits.
[[nodiscard]] Expected<render::Image> shallow_search_picture(render::Renderer& renderer, render::Size size);

/// Proposition 2.1: the two closest parallel planes that hold a body between them, and the ball in P + (-P) that says
/// so.
[[nodiscard]] Expected<render::Image> width_picture(render::Renderer& renderer, render::Size size);

/// Open problem (ii): the depth of a union of convex parts beside that of its hull.
[[nodiscard]] Expected<render::Image> non_convex_picture(render::Renderer& renderer, render::Size size);

}  // namespace pd::demo
