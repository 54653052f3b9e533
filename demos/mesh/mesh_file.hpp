/// @file
/// Points and faces of mesh files, at the precision that the file holds.
///
/// OBJ, OFF, PLY (text and binary) and STL text numbers are rounded once, to double; glTF 2 keeps its single precision,
/// and its nodes' transforms are applied in double. Materials, normals and textures are ignored.
/// XYZ (rows of numbers) and PCD (text and binary) are points without faces.
///
/// A file may come from a stranger: it is a regular file, and so is each file that it names, which stands in its own
/// folder; vertices, corners and bytes are counted before memory is spent on them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "pd/numeric/vector.hpp"

namespace pd::query {

/// Polygons over a list of points: loop f is corners[offsets[f]] to corners[offsets[f + 1] - 1].
struct MeshFaces {
  std::vector<std::int32_t> offsets{0};
  std::vector<std::int32_t> corners;
  /// Line of the file for each face; empty for formats without lines.
  std::vector<std::int32_t> lines;
  /// Group of each face, as an index of `group_names`; empty for formats without groups.
  std::vector<std::int32_t> groups;
  std::vector<std::string> group_names;

  [[nodiscard]] std::int64_t size() const { return static_cast<std::int64_t>(offsets.size()) - 1; }
};

/// The vertices that some face, line or point element refers to, in the order of the file; all of them where the file
/// has no elements (a point cloud).
struct MeshPoints {
  std::vector<Vec3> points;
  /// Index of each point among all vertices of the file, from 0. Empty where every vertex is there.
  std::vector<std::int32_t> ids;
  /// The file's polygons, as indices of `points`. Formats that repeat a vertex for each face (STL, and glTF for each
  /// normal) hold its point several times.
  MeshFaces faces;
  /// Number of points that are left out: a PCD or XYZ file has NaN where nothing was measured.
  std::int64_t left_out = 0;
};

/// True if the file's ending is that of a format which `read_mesh_points` reads.
[[nodiscard]] bool is_mesh_name(const std::filesystem::path& path);

/// Reads a mesh by its file ending (.obj, .off, .ply, .stl, .gltf, .glb, .xyz, .pcd; any case).
///
/// All meshes of a scene are taken, each where its nodes put it. Coordinates may still be infinite or NaN: the hull
/// builder refuses those by name.
/// @throws Refusal unreadable_file (missing, not a regular file, malformed, a glTF's buffer outside of its folder; the
/// message says the line, byte or member where it can), unsupported (compressed glTF or PCD) or limit_exceeded (more
/// vertices than `max_vertices`, more bytes than `max_bytes`, nodes or JSON nested too deep).
[[nodiscard]] MeshPoints read_mesh_points(const std::string& path, std::int64_t max_vertices, std::uintmax_t max_bytes);

/// Reads a mesh that has no name, from a pipe. Its first bytes tell its kind; text that is no OFF, PLY, STL or PCD is
/// OBJ.
/// @throws Refusal as `read_mesh_points`; unsupported for glTF, which names files beside it.
[[nodiscard]] MeshPoints read_mesh_bytes(const std::string& bytes, std::int64_t max_vertices);

}  // namespace pd::query
