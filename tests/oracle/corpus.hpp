/// @file
/// Text files of pairs: the shared hard cases, the regressions of `tests/corpus`, and the dump of a failing pair, all
/// in one format (schema pd-hard-pairs/1: shapes, poses, and what an oracle found).
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "oracle/exact_pair.hpp"
#include "pd/shape/convex_shape.hpp"

namespace pd::oracle {

/// A shape as the files write it. Points and sizes are rounded already where the case says float32.
struct ShapeText {
  std::string type;           ///< box, convex, sphere, capsule, cylinder, cone, ellipsoid
  std::vector<Vec3> points;   ///< corners of the core of a box, convex, sphere (one point) or capsule (two)
  double margin = 0;          ///< radius of a sphere or capsule
  Vec3 sizes = Vec3::Zero();  ///< half extents, radii, or (radius, half height, 0)
  int axis = 2;
  [[nodiscard]] bool polytope() const { return type == "box" || type == "convex"; }
  [[nodiscard]] bool rounded() const { return type == "sphere" || type == "capsule"; }
};

struct PoseText {
  Vec3 translation = Vec3::Zero();
  std::optional<std::array<double, 4>> quaternion_wxyz;
  Mat3 rotation = Mat3::Identity();
};

struct PairText {
  std::string name;
  std::string family;
  ShapeText shape_a;
  ShapeText shape_b;
  PoseText pose_a;
  PoseText pose_b;
  double tolerance = 0;        ///< absolute
  std::string contact;         ///< the file's oracle: class, "" when it does not say
  double signed_distance = 0;  ///< - depth, or distance
  std::string signed_distance_text;
  std::optional<Vec3> normal_a_to_b;
  int tied_directions = 0;
  bool curved = false;  ///< the file's figure is an upper bound of the depth only
};

/// Reads every case of a file. Throws std::runtime_error with the file's name when it cannot be read.
[[nodiscard]] std::vector<PairText> read_pairs(const std::string& path);
/// Every pairs_*.json of a folder, in the order of their names; empty when the folder is not there.
[[nodiscard]] std::vector<PairText> read_folder(const std::string& folder);
/// One case, pretty-printed, that `read_pairs` reads back bit for bit.
[[nodiscard]] std::string to_json(const PairText& pair, const std::string& note);
/// Appends `pair` to the file of pairs at `path`, creating it.
void append_pair(const std::string& path, const PairText& pair, const std::string& note);

/// Through the library's factories. Requires text that they accept.
[[nodiscard]] Pose make_pose(const PoseText& text);
[[nodiscard]] ConvexShape make_shape(const ShapeText& text);
[[nodiscard]] PairText describe(const std::string& name, const std::string& family, const std::vector<Vec3>& a,
                                const Pose& pose_a, const std::vector<Vec3>& b, const Pose& pose_b);

}  // namespace pd::oracle
