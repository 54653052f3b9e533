/// @file
/// A note says why a file is answered as its convex hull, and by how much the hull is larger. Points without faces have
/// no other body, the hull may be what was asked for, and some queries and demos are about hulls alone. An answer about
/// the hull of a mesh that is not convex must say that it is about another body.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "mesh/mesh_file.hpp"
#include "pd/shape/convex_polytope.hpp"
#include "pd/shape/mesh_check.hpp"

namespace pd::query {

struct HullNote {
  std::string reason;         ///< "the mesh is not convex"
  int vertices = 0;           ///< of the hull
  double times_as_large = 0;  ///< volume of the hull in volumes of the mesh; 0: the mesh encloses none
  std::int64_t left_out = 0;  ///< points of the file without a measurement (NaN), which the hull does not hold
};

/// Says in a few words why a mesh is not convex; empty for a mesh that is.
[[nodiscard]] std::string not_convex_because(const MeshPoints& mesh);

/// Nothing where the file's faces are the boundary of its hull, to kMeshPrecision.
[[nodiscard]] std::optional<HullNote> why_hull(const MeshPoints& mesh, const ConvexPolytope& hull);
/// Says it for a mesh whose report is there.
[[nodiscard]] std::optional<HullNote> why_hull(const SurfaceReport& report, const ConvexPolytope& hull);

/// Volume of a hull divided by the cube of `size`.
[[nodiscard]] double relative_volume(const ConvexPolytope& hull, double size);

/// "asked as the convex hull, since the mesh is not convex: 10 vertices, 1.167 times the mesh's volume"
[[nodiscard]] std::string in_words(const HullNote& note);

}  // namespace pd::query
