/// @file
/// Finds the faults of a triangle mesh before Bullet builds a tree of it.
///
/// Bullet reads wherever an index points to and sorts boxes of numbers that are none, so that a bad mesh has to be
/// refused before `btBvhTriangleMeshShape` sees it. What is merely useless (triangles without area or there twice,
/// edges of one or of three triangles) is counted; contacts are right with it.
#pragma once

#include <BulletCollision/CollisionShapes/btStridingMeshInterface.h>

#include <cstdint>

#include "pd/numeric/expected.hpp"

namespace pd {

struct MeshReport {
  std::int64_t triangles = 0;
  std::int64_t without_area = 0;  ///< corners on one line: no contacts come from them
  std::int64_t repeated = 0;      ///< same corners as an earlier one, in any order
  std::int64_t open_edges = 0;    ///< of one triangle, corners compared by their coordinates
  std::int64_t forked_edges = 0;  ///< of three triangles or more
};

/// Reads every part of the mesh. Corners are compared bit by bit but for the sign of 0, so that seams between parts
/// close where their coordinates agree.
/// @return `non_finite` for a coordinate or scaling that is no number, `out_of_range` for an index beyond the part's
/// vertices or a coordinate beyond kMaxCoordinate. `unsupported` for indices that are not 8, 16 or 32 bits or
/// vertices that are not float or double. `bad_value` for counts or strides below 0 or a missing array. `where` names
/// the place, e.g.
/// "parts[0].triangles[12]". Expected time O(n), n triangles.
[[nodiscard]] Expected<MeshReport> check_mesh(const btStridingMeshInterface& mesh);

}  // namespace pd
