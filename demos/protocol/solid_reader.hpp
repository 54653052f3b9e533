/// @file
/// Meshes that are asked as the solids that they bound.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "mesh/mesh_file.hpp"
#include "pd/shape/mesh_solid.hpp"
#include "protocol/body_reader.hpp"
#include "protocol/line/line_notes.hpp"

namespace pd::query {

/// Options by which a file's mesh is asked as a solid.
struct SolidWish {
  bool always = false;      ///< also where the mesh is convex
  bool turn_faces = false;  ///< a mesh that is wholly inside out is turned
  /// Words by which a person or a program asks for the hull instead; refusals quote them.
  std::string hull_words = "\"as\":\"hull\"";
  /// Words by which one asks for a mesh turned.
  std::string turn_words = "\"turn_faces\":true";
  /// Words by which one asks for the union of a mesh's parts; none where that cannot be asked.
  std::string parts_words = "\"as\":\"parts\"";
  /// The length of which the precision is a share, where the mesh is a part of a file; 0: the mesh's own extent.
  double extent = 0;
};

/// The body of a mesh: its solid, or the hull where the mesh is convex or has no faces.
/// @throws Refusal by the word of the fault (open_edge, ...) with the faces, their lines of the file, and the ways out;
/// those of the hull.
[[nodiscard]] MeshBody body_of_mesh(MeshPoints mesh, const std::string& name, const SolidWish& wish);

/// The solid of a shape {"type":"mesh"}, as above; null for other shapes, and for meshes asked as their hull. A line
/// reads a file once.
[[nodiscard]] std::shared_ptr<const MeshSolid> read_solid(const Node& node, const Limits& limits);

/// True if "a" or "b" of a line is, or holds in a compound, a mesh that is asked as a solid.
[[nodiscard]] bool names_solid(const Node& line, const Limits& limits);

/// Either body of a query about solids: a mesh's, or a convex polytope's without a margin; null for others.
[[nodiscard]] std::shared_ptr<const MeshSolid> read_as_solid(const Node& node, const Limits& limits);

/// The convex shape of a query beside a solid: curved, or swept by a margin. Bodies that are not convex give nothing,
/// and so do flat polytopes without a margin: both are asked as parts of a union.
[[nodiscard]] std::optional<ConvexShape> read_beside_solid(const Node& node, const Limits& limits);

/// True if a shape is a mesh whose groups are asked as the parts of a compound ("as":"parts").
[[nodiscard]] bool is_mesh_of_parts(const Node& node);

/// The union of the groups of a mesh file, each of which is convex or a solid with parts as `parts_of_solid` takes
/// them. A group that bounds no solid as a whole, since its surfaces cross or touch, is the union of those surfaces.
/// @throws Refusal as `body_of_mesh` and `parts_of_solid`, with the part that is at fault; bad_faces for a file without
/// faces.
[[nodiscard]] NamedBody parts_of_mesh(const MeshPoints& mesh, const std::string& name, const SolidWish& wish);

/// True if a mesh of several groups or surfaces is answered by `parts_of_mesh`; false above 5,000 faces.
[[nodiscard]] bool answers_as_parts(const MeshPoints& mesh, const SolidWish& wish);

/// Reads a shape {"type":"mesh","as":"parts"}, from its file or its own numbers. @throws Refusal as `parts_of_mesh`
[[nodiscard]] NamedBody read_mesh_parts(const Node& node, const Limits& limits);

/// The union of the convex parts of a solid.
/// @throws Refusal unsupported where the parts are not the solid exactly, limit_exceeded for too many of them.
[[nodiscard]] NamedBody parts_of_solid(const MeshSolid& solid, const Node& node);

}  // namespace pd::query
