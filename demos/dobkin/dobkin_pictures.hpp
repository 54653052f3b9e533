/// @file
/// The constructions of [D] as pictures, each understandable on its own.
///
/// [D] Dobkin, Hershberger, Kirkpatrick, Suri, "Computing the intersection-depth of polyhedra", 1993.
#pragma once

#include "pd/numeric/expected.hpp"
#include "pd/render/renderer.hpp"

namespace pd::demo {

/// Section 5.1, Fact 5.1: levels of the inner hierarchy growing into the body, of the outer one shrinking onto it.
[[nodiscard]] Expected<render::Image> hierarchy_picture(render::Renderer& renderer, render::Size size);

/// Lemma 5.4: one search down the inner hierarchy: a plane for every level, and the caps that come in beyond it.
[[nodiscard]] Expected<render::Image> descent_picture(render::Renderer& renderer, render::Size size);

/// Section 4: a polygon with a hole, a convex one that moves, and their convolution with its arcs, holes and the
/// shortest way out.
[[nodiscard]] Expected<render::Image> polygons_picture(render::Renderer& renderer, render::Size size);

}  // namespace pd::demo
