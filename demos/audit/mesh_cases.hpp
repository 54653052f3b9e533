/// @file
/// Pairs of hulls of a user's meshes, as a record that recorder programs read.
#pragma once

#include <string>
#include <vector>

#include "audit/accuracy_run.hpp"

namespace pd::audit {

/// A record in a temporary file, gone with this object. Every mesh meets the next one in the order of their paths, and
/// the last the first, in random attitudes at each of four depths: apart by 1 % of the smaller one's size, overlapping
/// by 1 % and by 10 %, and centred on each other. The hulls are those of `query::read_mesh_points`.
class MeshCases {
 public:
  /// @param folder  searched with its folders for OBJ, STL, PLY, OFF, glTF, XYZ and PCD files
  MeshCases(const std::string& folder, const AccuracySettings& settings);
  ~MeshCases();
  MeshCases(const MeshCases&) = delete;
  MeshCases& operator=(const MeshCases&) = delete;

  /// False where no mesh could be read or the file cannot be written.
  [[nodiscard]] bool good() const { return good_; }
  [[nodiscard]] const std::string& path() const { return path_; }
  /// Files that were left out, and why.
  [[nodiscard]] const std::vector<std::string>& complaints() const { return complaints_; }

 private:
  bool good_ = false;
  std::string path_;
  std::vector<std::string> complaints_;
};

}  // namespace pd::audit
