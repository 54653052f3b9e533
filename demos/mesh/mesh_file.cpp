#include "mesh/mesh_file.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <iterator>
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
  if (ending == ".gltf" || ending == ".glb") return read_gltf(path, std::move(bytes), max_vertices, max_bytes);
  if (ending == ".obj") return read_obj(bytes, max_vertices);
  if (ending == ".off") return read_off(bytes, max_vertices);
  if (ending == ".ply") return read_ply(bytes, max_vertices);
  return read_stl(bytes, max_vertices);
}

}  // namespace

MeshPoints read_mesh_points(const std::string& path, std::int64_t max_vertices, std::uintmax_t max_bytes) {
  static constexpr const char* kEndings[] = {".obj", ".off", ".ply", ".stl", ".gltf", ".glb"};
  const std::string ending = lower_ending(path);
  if (std::none_of(std::begin(kEndings), std::end(kEndings), [&](const char* known) { return ending == known; })) {
    refuse("unreadable_file", path + ": the file ending must be .obj, .off, .ply, .stl, .gltf or .glb", "");
  }
  try {
    MeshPoints mesh = read_by_ending(path, ending, max_vertices, max_bytes);
    if (mesh.points.empty()) refuse("unreadable_file", "the file holds no vertices", "");
    return mesh;
  } catch (const Refusal& refusal) {
    const bool named = refusal.message.starts_with(path);
    refuse(refusal.code, named ? refusal.message : path + ": " + refusal.message, "");
  }
}

}  // namespace pd::query
