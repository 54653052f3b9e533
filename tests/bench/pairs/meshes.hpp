/// @file
/// The same over a user's own meshes: the hull of each file, against the hulls of the others in random attitudes.
#pragma once

#include <filesystem>

#include "bench/pairs/pairs.hpp"

namespace pd::bench {

/// Hulls of all mesh files below `folder` (OBJ, STL, PLY, OFF, glTF; at the single precision that Assimp keeps), in the
/// order of their paths. Files that cannot be read or have no solid hull are named on stderr and left out. Error where
/// the folder cannot be read or holds none.
struct NamedShape {
  std::string name;
  ConvexShape shape;
};
[[nodiscard]] Expected<std::vector<NamedShape>> read_meshes(const std::filesystem::path& folder);

/// One cell for each mesh and depth: `pairs` draws against a random partner among all meshes (itself included), the
/// partner scaled to the same size. A cell is named by the mesh's file, its size is that of the hull.
[[nodiscard]] std::vector<Row> run_meshes(const std::vector<NamedShape>& meshes, int pairs, std::uint64_t seed,
                                          Solvers& solvers);

}  // namespace pd::bench
