/// @file
/// The distance of two solids whose surfaces do not meet: the nearest pair of triangles.
#pragma once

#include "pd/depth/scratch.hpp"
#include "pd/solid/solid_depth.hpp"
#include "solid/posed_solids.hpp"

namespace pd::detail {

/// The convex core's answer about two triangles, exact on the stored numbers.
[[nodiscard]] PenetrationDepth answer_of_triangles(const PosedSolids& solids, std::int32_t triangle_a,
                                                   std::int32_t triangle_b, Scratch& scratch);

/// Requires separated solids. Fills class, distance, witnesses, normal and faces.
///
/// Doubles find the pairs of triangles that may be nearest, by a plane between the two that bounds their distance from
/// below. The convex core answers these exactly, the nearest first, until the bracket is tight.
void set_distance(const PosedSolids& solids, Scratch& scratch, SolidDepth& out);

}  // namespace pd::detail
