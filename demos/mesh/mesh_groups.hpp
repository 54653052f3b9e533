/// @file
/// The groups of a mesh file (`o` and `g` of an OBJ, the meshes that a glTF's scene shows), each as a mesh of its own.
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

}  // namespace pd::query
