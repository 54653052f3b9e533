/// @file
/// Finds the faults of a triangle mesh before Bullet builds a tree of it.
///
/// Bullet reads wherever an index points to and sorts boxes of numbers that are none, so that a bad mesh has to be
/// refused before `btBvhTriangleMeshShape` sees it. What is merely useless (triangles without area or there twice,
/// edges of one or of three triangles) is counted; contacts are right with it.
#pragma once

#include <BulletCollision/CollisionShapes/btStridingMeshInterface.h>

#include "pd/numeric/expected.hpp"
#include "pd/shape/mesh_check.hpp"

namespace pd {

/// Reads every part of the mesh, and checks all of their triangles as one mesh of the core's (pd/shape/mesh_check.hpp),
/// without a search for crossings. Its faces are the triangles in their order, and its points their corners, three of
/// each. Corners with equal coordinates are one vertex, so that seams between parts close.
/// @return `non_finite` for a coordinate or scaling that is no number, `out_of_range` for an index beyond the part's
/// vertices or a coordinate beyond kMaxCoordinate, `too_few_points` for no triangles. `unsupported` for indices that
/// are not 8, 16 or 32 bits or vertices that are not float or double. `bad_value` for counts or strides below 0 or a
/// missing array. `where` names the place, e.g. "parts[0].triangles[12]". Time O(n log n), n triangles.
[[nodiscard]] Expected<SurfaceReport> check_mesh(const btStridingMeshInterface& mesh);

}  // namespace pd
