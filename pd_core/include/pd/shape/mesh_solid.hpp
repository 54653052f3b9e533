/// @file
/// A closed mesh as the solid that it bounds: not convex in general, with cavities and several parts.
///
/// The solid is the closure of the points that the surface encloses. Vertices stay as they were given. A polygon is the
/// triangles that it is cut into, which matters only where its corners do not lie in one plane exactly.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pd/numeric/expected.hpp"
#include "pd/shape/convex_polytope.hpp"
#include "pd/shape/mesh_check.hpp"
#include "pd/shape/triangle_node.hpp"

namespace pd {

struct MeshSolidSettings {
  /// Turns the faces of a mesh that is wholly inside out; without it such a mesh is refused.
  bool turn_faces = false;
};

/// Immutable. It holds some 80 to 100 bytes a triangle.
class MeshSolid {
 public:
  /// A triangle of the surface, counter-clockwise seen from outside.
  struct Triangle {
    std::array<std::int32_t, 3> vertices;
    std::array<std::int32_t, 3> neighbours;  ///< across the edges from vertex 0 to 1, 1 to 2 and 2 to 0
    std::int32_t face = 0;                   ///< of the caller
    std::int32_t shell = 0;                  ///< the connected part of the surface, in [0, num_shells())
  };

  /// @return The errors of `check_mesh`; bad_faces, or not_closed for open edges, for a mesh that bounds no solid. The
  /// message begins with the word of the fault (`to_string(MeshFault)`) and says where it is. limit_exceeded where the
  /// search for crossings did not end.
  /// Time O(n log n) as of `check_mesh`.
  static Expected<MeshSolid> from_faces(const MeshView& mesh, const MeshSolidSettings& settings = {});

  /// Takes a report of the mesh, whose crossings were searched, instead of checking it again.
  static Expected<MeshSolid> from_checked(const MeshView& mesh, const SurfaceReport& report,
                                          const MeshSolidSettings& settings = {});

  /// A convex polytope, its facets cut into triangles; vertices and faces are the polytope's own.
  /// @return not_full_dimensional for a flat polytope, which bounds no solid.
  static Expected<MeshSolid> from_polytope(const ConvexPolytope& polytope);

  [[nodiscard]] const std::vector<Vec3>& vertices() const { return vertices_; }
  /// In the order of the tree's leaves.
  [[nodiscard]] const std::vector<Triangle>& triangles() const { return triangles_; }
  /// The hierarchy of boxes; the root is first.
  [[nodiscard]] const std::vector<TriangleNode>& nodes() const { return nodes_; }
  [[nodiscard]] std::int32_t num_shells() const { return num_shells_; }
  [[nodiscard]] const Vec3& vertex(std::int32_t v) const { return vertices_[static_cast<std::size_t>(v)]; }
  [[nodiscard]] const Triangle& triangle(std::int32_t t) const { return triangles_[static_cast<std::size_t>(t)]; }

 private:
  MeshSolid() = default;
  /// Sorts the triangles into the tree, and finds neighbours and shells.
  std::optional<Error> arrange();

  std::vector<Vec3> vertices_;
  std::vector<Triangle> triangles_;
  std::vector<TriangleNode> nodes_;
  std::int32_t num_shells_ = 0;
};

/// The first fault that keeps a mesh from bounding a solid, in the order of the enumeration; nothing for a solid. Faces
/// without an area are a fault where no other face is there.
/// @param turn_faces  a mesh that is wholly inside out counts as a solid.
[[nodiscard]] std::optional<MeshFinding> fault_of_solid(const SurfaceReport& report, bool turn_faces = false);

/// Says for people what is wrong at a fault, and where.
[[nodiscard]] std::string in_words(const MeshFinding& finding);

}  // namespace pd
