#include "mesh/mesh_file.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <iterator>
#include <string_view>
#include <utility>

#include "files/regular_file.hpp"
#include "mesh/mesh_text.hpp"

namespace pd::query {

namespace {

std::string lower_ending(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending;
}

MeshPoints read_by_ending(const std::string& path, const std::string& ending, std::int64_t max_vertices,
                          std::uintmax_t max_bytes) {
  std::string bytes = RegularFile::open(path, max_bytes).read_all();
  if (bytes.empty()) refuse("unreadable_file", "the file is empty", "");
  if (ending == ".gltf" || ending == ".glb") return read_gltf(path, std::move(bytes), max_vertices, max_bytes);
  if (ending == ".obj") return read_obj(bytes, max_vertices);
  if (ending == ".off") return read_off(bytes, max_vertices);
  if (ending == ".ply") return read_ply(bytes, max_vertices);
  if (ending == ".xyz") return read_xyz(bytes, max_vertices);
  if (ending == ".pcd") return read_pcd(bytes, max_vertices);
  return read_stl(bytes, max_vertices);
}

MeshPoints read_by_first_bytes(const std::string& bytes, std::int64_t max_vertices) {
  const std::string_view text = bytes;
  const std::string_view word = text.substr(0, text.find_first_of(" \t\r\n"));
  if (text.starts_with("glTF") || text.starts_with("{")) {
    refuse("unsupported", "glTF may name files beside it: give its file's name", "");
  }
  if (word.ends_with("OFF")) return read_off(text, max_vertices);
  if (word == "ply") return read_ply(text, max_vertices);
  if (text.starts_with("# .PCD") || word == "VERSION" || word == "FIELDS") return read_pcd(text, max_vertices);
  // An STL of bytes: 80 of any kind, the number of triangles, 50 for each.
  constexpr std::size_t kHead = 84, kTriangle = 50;
  const bool binary = text.size() >= kHead && (text.size() - kHead) % kTriangle == 0 && text.find('\0') != text.npos;
  if (is_word(word, "solid") || binary) return read_stl(text, max_vertices);
  return read_obj(text, max_vertices);
}

MeshPoints require_vertices(MeshPoints mesh) {
  if (mesh.points.empty()) refuse("unreadable_file", "the file holds no vertices", "");
  return mesh;
}

}  // namespace

MeshPoints read_mesh_bytes(const std::string& bytes, std::int64_t max_vertices) {
  if (bytes.empty()) refuse("unreadable_file", "it is empty", "");
  MeshPoints mesh = read_by_first_bytes(bytes, max_vertices);
  if (mesh.points.empty()) {
    refuse(
        "unreadable_file",
        "no vertices; a mesh without a name is OBJ, OFF, PLY, STL or PCD, other formats are told by their file's name",
        "");
  }
  return mesh;
}

bool is_mesh_name(const std::filesystem::path& path) {
  static constexpr const char* kEndings[] = {".obj", ".off", ".ply", ".stl", ".gltf", ".glb", ".xyz", ".pcd"};
  const std::string ending = lower_ending(path);
  return std::any_of(std::begin(kEndings), std::end(kEndings), [&](const char* known) { return ending == known; });
}

MeshPoints read_mesh_points(const std::string& path, std::int64_t max_vertices, std::uintmax_t max_bytes) {
  if (path == "-") {
    refuse("unreadable_file", "-: a file is expected; `pdepth depth` alone reads a mesh from standard input", "");
  }
  if (path.empty()) refuse("unreadable_file", "the name of the file is empty", "");
  if (!is_mesh_name(path)) {
    refuse("unreadable_file", path + ": the file ending must be .obj, .off, .ply, .stl, .gltf, .glb, .xyz or .pcd", "");
  }
  try {
    return require_vertices(read_by_ending(path, lower_ending(path), max_vertices, max_bytes));
  } catch (const Refusal& refusal) {
    const bool named = refusal.message.starts_with(path);
    refuse(refusal.code, named ? refusal.message : path + ": " + refusal.message, "");
  }
}

}  // namespace pd::query
