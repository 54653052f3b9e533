/// @file
/// Exact contacts in MuJoCo: one call replaces the collision functions of convex pairs, another puts MuJoCo's own back.
///
///   if (const auto installed = pd::install_mujoco(); !installed) std::puts(installed.error().message.c_str());
///   mj_step(model, data);
///   pd::uninstall_mujoco();
///
/// Boxes, spheres, capsules, cylinders, ellipsoids and meshes (their convex hulls, as MuJoCo takes them) are answered
/// against each other and against planes. Height fields, distance fields and soft bodies stay MuJoCo's. Contacts mean
/// what MuJoCo means by them: `pos` midway between the two surfaces, the normal from the first geom to the second,
/// `dist` negative in depth, points nearer than the margin. MuJoCo applies the gap. Positions and normals are in the
/// frame of the world, lengths in the unit of the model.
///
/// A contact depends on the model and on the poses in `mjData` alone, like MuJoCo's own. One state gives the same bits
/// on any thread and after any history, unless `remember_pairs` is set.
///
/// The time of a pair is that of `penetration_depth` and `contact_manifold`, and O(n) more to compare the n vertices of
/// a mesh with those that were converted.
#pragma once

#include <mujoco/mujoco.h>

#include <array>
#include <cstdint>
#include <string>

#include "pd/numeric/expected.hpp"

namespace pd {

struct MujocoOptions {
  /// For cylinders and ellipsoids: the relative error of the depth, in (0, 1]; 0 stands for 1e-6. All other depths are
  /// exact up to rounding.
  double delta = 0;
  /// Each thread keeps the last answer of each pair and begins with it. Hulls of many vertices are answered faster; the
  /// last bits then depend on what the thread was asked before.
  bool remember_pairs = false;
  /// Says which pairs pdepth answers; null: all. It is called for every pair in every step, by several threads at once.
  bool (*takes_pair)(const mjModel* model, int geom1, int geom2, void* user) = nullptr;
  /// Gets one line when a pair is left to MuJoCo for the first time for a reason; null: silence. Any thread that is
  /// inside MuJoCo may call it.
  void (*warning)(const char* line, void* user) = &print_warning;
  void* user = nullptr;  ///< is handed to `takes_pair` and `warning`

  /// Writes the line to the standard error stream.
  static void print_warning(const char* line, void* user);
};

/// The reason why a pair got MuJoCo's own contact.
enum class MujocoRefusal : std::uint8_t {
  pose,  ///< a pose is NaN, infinite or no rotation (the kinematics were never run)
  size,  ///< a size is not positive and finite
  mesh,  ///< vertices of a mesh are missing or not finite
};
inline constexpr int kMujocoRefusals = 3;

/// Counts of all threads since `install_mujoco`.
struct MujocoReport {
  std::int64_t answered = 0;                         ///< pairs
  std::int64_t contact_points = 0;                   ///< written for them
  std::int64_t conversions = 0;                      ///< geoms made into shapes
  std::array<std::int64_t, kMujocoRefusals> left{};  ///< pairs left to MuJoCo, by MujocoRefusal
  std::array<std::string, kMujocoRefusals> first{};  ///< the first pair of each: its geom and the error
};

/// Replaces the entries of `mjCOLLISIONFUNC` for convex pairs and planes; null entries stay null. Called again, it
/// changes the options and starts the report afresh; entries that somebody else has replaced since stay theirs.
/// Requires that no thread is inside MuJoCo, because the table belongs to the whole process.
///
/// @return the number of entries that are pdepth's, or ErrorCode::bad_value ("delta") or unsupported (the library is of
/// another version than the header that pdepth was compiled with).
Expected<int> install_mujoco(const MujocoOptions& options = {});

/// Puts back the entries that stood in the table before. An entry that somebody else has replaced since stays theirs.
/// Requires that no thread is inside MuJoCo. Does nothing if nothing is installed.
void uninstall_mujoco();

/// The counts so far, of all threads. May be called at any time, by any thread. Time O(threads).
[[nodiscard]] MujocoReport mujoco_report();

}  // namespace pd
