/// @file
/// The parts of a mesh file, each as a mesh of its own: its groups (`o` and `g` of an OBJ, the meshes that a glTF's
/// scene shows), and the connected surfaces of a group.
#pragma once

#include <string>
#include <vector>

#include "mesh/mesh_file.hpp"

namespace pd::query {

struct MeshGroup {
  /// "part 2 (\"lid\")", numbered from 0 in the order of the file, for messages.
  std::string name;
  /// Its ids are those of the file.
  MeshPoints mesh;
};

/// The groups that have faces. A mesh without groups is one.
[[nodiscard]] std::vector<MeshGroup> groups_of(const MeshPoints& mesh);

/// The connected surfaces of a group, "part 2 (\"lid\"), surface 0" and so on.
[[nodiscard]] std::vector<MeshGroup> surfaces_of(const MeshGroup& group);

/// True if a mesh has several groups, or several connected surfaces of enough faces each to bound a part.
[[nodiscard]] bool has_parts(const MeshPoints& mesh);

}  // namespace pd::query
