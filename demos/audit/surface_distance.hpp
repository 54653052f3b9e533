/// @file
/// How far a point is from the surface of a posed body.
#pragma once

#include "audit/recorded_shape.hpp"
#include "pd/depth/scratch.hpp"

namespace pd::audit {

/// The least distance from `point` to the boundary of the body (of flat bodies: to the body itself).
///
/// Polytopes and swept polytopes: in doubles, to a few ulp of the coordinates in the body's frame; curved bodies and
/// unions: from the library's bracket of relative width `delta`, its lower end (unions: `kFinestUnionDelta` at least).
/// Time O(facets) for polytopes.
[[nodiscard]] double surface_distance(const RecordedShape& shape, const Pose& pose, const Vec3& point, double delta,
                                      Scratch& scratch);

}  // namespace pd::audit
