/// @file
/// Shapes and poses of the line protocol.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "mesh/hull_note.hpp"
#include "mesh/mesh_file.hpp"
#include "pd/shape/convex_shape.hpp"
#include "protocol/line/field_reader.hpp"
#include "protocol/line/limits.hpp"

namespace pd::query {

/// A shape as the caller knows it.
struct NamedShape {
  ConvexShape shape;
  /// Where the hull was given a selection of the caller's points (a mesh file's referenced vertices): the caller's id
  /// of each. Empty: the hull's own caller ids are right.
  std::vector<std::int32_t> selected_ids;
  /// Why a mesh is answered as its convex hull; nothing for other shapes, and for meshes that are convex.
  std::optional<HullNote> hull_note = std::nullopt;

  /// The caller's id of a vertex of the polytope core.
  [[nodiscard]] int caller_id(int vertex) const {
    const int id = shape.polytope()->caller_id(vertex);
    return selected_ids.empty() ? id : selected_ids[static_cast<std::size_t>(id)];
  }
};

/// Reads a convex shape. Refuses as the protocol says; compounds and star-shaped bodies as unsupported (`read_body`
/// reads them).
[[nodiscard]] NamedShape read_shape(const Node& node, const Limits& limits);

/// The polytope core of a body without a margin; refused where there is none.
[[nodiscard]] const ConvexPolytope& require_polytope(const NamedShape& named, const Node& node);

/// Reads a pose; the identity where a part is missing.
[[nodiscard]] Pose read_pose(const Node& node);

/// Names the words that "as" of a mesh may hold, for refusals.
inline constexpr const char* kMeshWords = "must be \"solid\", \"hull\", \"parts\" or \"sheet\"";

/// The ways in which a hull is made of a mesh.
enum class MeshAs {
  found,   ///< as it is where it is convex, else as its hull, with a note
  convex,  ///< as it is: a check found it convex
  hull,    ///< as its hull, and nothing else is looked at
};

/// The hull of a mesh file's referenced vertices, with a note where the file holds something else. @throws Refusal
/// unreadable_file or limit_exceeded without a path, or a refusal of the hull.
[[nodiscard]] NamedShape load_mesh_shape(const std::string& path, const Limits& limits, MeshAs as = MeshAs::found);

/// Refuses a file's mesh: "FILE: PLACE: what is wrong", in the factory's words. @throws Refusal
[[noreturn]] void refuse_file(const std::string& name, const Error& error);

/// The hull of points that were read already. @param name  begins what is said when the hull is refused
[[nodiscard]] NamedShape hull_of_mesh(MeshPoints mesh, const std::string& name, MeshAs as = MeshAs::found);

}  // namespace pd::query
