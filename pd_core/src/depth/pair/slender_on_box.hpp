/// @file
/// A point or a segment (the cores of spheres and capsules) over one face of a box, in closed form: no memory, no
/// search.
///
/// In the box's own coordinates the face is the one whose plane has the whole body before it, and the nearest point of
/// the body is the end nearest to that plane, where its foot falls on the face. Then the face's plane bounds the
/// distance from below, and the foot, a point of the box, from above: both are the height of the end over the plane, up
/// to rounding that scales with the end's place and not with the reach of the box.
#pragma once

#include "depth/pair/polytope_depth.hpp"
#include "pd/depth/depth_answer.hpp"

namespace pd::detail {

/// `Bracket::contact` alone, for bodies at rest. Passes on where the body meets an edge or a corner, cuts the box, or
/// is none of these.
bool answer_slender_on_box(const PolytopePair& pair, const DepthSettings& settings, PenetrationDepth& out);

}  // namespace pd::detail
