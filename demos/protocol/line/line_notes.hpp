/// @file
/// What the readers of one line note for the rest of its answer.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "pd/shape/mesh_solid.hpp"

namespace pd::query {

/// A word that the answer must say about a part of the line, which stands at a path.
struct Remark {
  std::string path;
  std::string word;
};

struct LineNotes {
  std::vector<Remark> remarks;
  /// Solids of mesh files, by file and wish: the choice of the handler and the handler itself ask for them. Null: the
  /// mesh is asked as its hull.
  std::map<std::string, std::shared_ptr<const MeshSolid>> solids;
};

}  // namespace pd::query
