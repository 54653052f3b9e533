/// @file
/// A point or a segment (the cores of spheres and capsules) apart from a box, in closed form: over a face or an edge,
/// beside a corner, wherever along the segment.
///
/// The nearest place of the segment names the face, the edge or the corner (segment_beside_box.hpp). The rest is the
/// height of an end over a face, or the distance of two segments (nearest_of_segments.hpp), bounded from below over the
/// whole box: a wrong name gives a wide bracket and is passed on.
#pragma once

#include "depth/pair/polytope_depth.hpp"
#include "pd/depth/depth_answer.hpp"

namespace pd::detail {

/// Bracket::certified and contact. Passes on where the core cuts the box, and where bracket or class stay in doubt.
bool answer_slender_near_box(const PolytopePair& pair, const DepthSettings& settings, Bracket bracket,
                             PenetrationDepth& out);

}  // namespace pd::detail
