#include "mesh/mesh_file.hpp"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <system_error>

#include "mesh/mesh_text.hpp"

namespace pd::query {

namespace {

std::string lower_ending(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending;
}

std::string read_bytes(const std::string& path, std::uintmax_t size) {
  std::ifstream file(path, std::ios::binary);
  if (!file) refuse("unreadable_file", path + ": " + std::strerror(errno), "");
  std::string bytes(static_cast<std::size_t>(size), '\0');
  file.read(bytes.data(), static_cast<std::streamsize>(size));
  bytes.resize(static_cast<std::size_t>(file.gcount()));
  if (file.bad()) refuse("unreadable_file", path + ": the file cannot be read to its end", "");
  return bytes;
}

MeshPoints read_by_ending(const std::string& path, const std::string& ending, std::uintmax_t size,
                          std::int64_t max_vertices) {
  if (ending == ".gltf" || ending == ".glb") return read_gltf(path, max_vertices);
  const std::string bytes = read_bytes(path, size);
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
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) refuse("unreadable_file", path + ": there is no such file", "");
  if (!std::filesystem::is_regular_file(status)) refuse("unreadable_file", path + ": not a regular file", "");
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) refuse("unreadable_file", path + ": " + error.message(), "");
  if (size > max_bytes) {
    refuse("limit_exceeded", path + ": more than " + std::to_string(max_bytes) + " bytes", "");
  }
  try {
    MeshPoints mesh = read_by_ending(path, ending, size, max_vertices);
    if (mesh.points.empty()) refuse("unreadable_file", "the file holds no vertices", "");
    return mesh;
  } catch (const Refusal& refusal) {
    const bool named = refusal.message.starts_with(path);
    refuse(refusal.code, named ? refusal.message : path + ": " + refusal.message, "");
  }
}

}  // namespace pd::query
