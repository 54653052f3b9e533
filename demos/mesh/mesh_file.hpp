/// @file
/// Points of mesh files, at the precision that the file holds.
///
/// OBJ, OFF, PLY (text and binary) and STL are read here: text numbers are rounded once, to double. glTF goes through
/// Assimp, which keeps single precision, as glTF itself does. Materials, normals and textures are ignored.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pd/numeric/vector.hpp"

namespace pd::query {

/// The vertices that some face, line or point element refers to, in the order of the file; all of them where the file
/// has no elements (a point cloud).
struct MeshPoints {
  std::vector<Vec3> points;
  /// Index of each point among all vertices of the file, from 0. Empty where every vertex is there.
  std::vector<std::int32_t> ids;
};

/// Reads a mesh by its file ending (.obj, .off, .ply, .stl, .gltf, .glb; any case).
///
/// All meshes of a scene are taken, each where its nodes put it. Coordinates may still be infinite or NaN: the hull
/// builder refuses those by name.
/// @throws Refusal unreadable_file (missing, not a regular file, malformed; the message says the line or byte where it
/// can) or limit_exceeded (more vertices than `max_vertices`, more bytes than `max_bytes`).
[[nodiscard]] MeshPoints read_mesh_points(const std::string& path, std::int64_t max_vertices, std::uintmax_t max_bytes);

}  // namespace pd::query
