/// @file
/// Shapes and poses of the line protocol.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pd/shape/convex_shape.hpp"
#include "protocol/field_reader.hpp"
#include "protocol/limits.hpp"

namespace pd::query {

/// A shape as the caller knows it.
struct NamedShape {
  ConvexShape shape;
  /// Where the hull was given a selection of the caller's points (a mesh file's referenced vertices): the caller's id
  /// of each. Empty: the hull's own caller ids are right.
  std::vector<std::int32_t> selected_ids;

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

/// The hull of a mesh file's referenced vertices. @throws Refusal unreadable_file or limit_exceeded without a path, or
/// a refusal of the hull.
[[nodiscard]] NamedShape load_mesh_shape(const std::string& path, const Limits& limits);

}  // namespace pd::query
