/// @file
/// Notes that the readers of one line make for the rest of its answer.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "pd/shape/mesh_solid.hpp"

namespace pd::query {

/// A word that the answer must say about a part of the line, which stands at a path.
struct Remark {
  std::string path;
  std::string word;
  std::int64_t left_out = 0;  ///< points of a file without a measurement (NaN), which the body does not hold
};

struct NamedShape;

/// A mesh file as the line asks it: the solid, or the hull of a mesh that is convex or has no faces.
struct MeshBody {
  std::shared_ptr<const MeshSolid> solid;
  std::shared_ptr<const NamedShape> hull;
};

/// Makes a key of the way in which a line asks a file. @param as  the word of "as", or nothing
[[nodiscard]] inline std::string mesh_key(std::string_view as, bool turned, const std::string& file) {
  return std::string(as) + (turned ? " turned/" : "/") + file;
}

struct LineNotes {
  std::vector<Remark> remarks;
  /// Bodies of mesh files, by file and wish: the choice of the handler and the handler itself ask for them, and "a" and
  /// "b" may be one file. So a line reads and checks a file once.
  std::map<std::string, MeshBody> meshes;
};

}  // namespace pd::query
