/// @file
/// Records MuJoCo's contacts for `pdepth audit`: the answer of its narrow phase for each pair, by MuJoCo or by pdepth.
///
///   pd::MujocoRecorder recorder(model, "contacts.jsonl");
///   for (int step = 0; step < 60; ++step) mj_step(model, data);
///   if (!recorder.close()) std::perror("contacts.jsonl");
///
/// The format is that of `pd/record/pd_record.h`.
#pragma once

#include <mujoco/mujoco.h>

#include <cstdint>
#include <memory>

namespace pd {

namespace detail {
class RecordedModel;
}

/// Records while it lives. A function of pdepth then stands in MuJoCo's table and hands every call on to MuJoCo's own
/// function or to that of `install_mujoco`, which may be installed and uninstalled meanwhile. Begin and end a recorder
/// while no thread is inside MuJoCo.
///
/// The recorder writes a line for every pair of this model that the narrow phase is asked about, if both geoms are
/// convex or one is a plane. If the answer has no contact, the line says `null`. Else it reports the deepest point with
/// its normal, and then all points. A is MuJoCo's first geom. Poses, lengths and the time are those of `mjData`, in the
/// frame of the world and in the model's units.
///
/// Pairs without an exact shape or pose (bad sizes, poses that are no rotations) are counted as `unsupported` and not
/// written. Height fields and soft bodies are not seen. Threads write one at a time. A line takes O(s) time in the
/// shapes of the record.
class MujocoRecorder {
 public:
  /// Creates the file. If it cannot be created, or the model has a recorder already, `good` is false.
  /// @param model  must outlive the recorder
  MujocoRecorder(const mjModel* model, const char* path);
  ~MujocoRecorder();
  MujocoRecorder(const MujocoRecorder&) = delete;
  MujocoRecorder& operator=(const MujocoRecorder&) = delete;

  /// Ends the recording and closes the file. A second call does nothing and returns the same.
  /// @return false if something could not be written
  bool close();

  /// True if the file was created and everything was written so far.
  [[nodiscard]] bool good() const;
  [[nodiscard]] std::int64_t contacts() const;     ///< lines written
  [[nodiscard]] std::int64_t unsupported() const;  ///< pairs that were not written

 private:
  std::unique_ptr<detail::RecordedModel> model_;
};

/// Records the contacts of one state, in one call: those that MuJoCo finds for the poses in `data`, which stays as it
/// is. Requires that no thread is inside MuJoCo. Takes the time of a copy of `data` and of `mj_collision`.
/// @return false if the file cannot be written, or the model has a recorder already
bool record_mujoco(const mjModel* model, const mjData* data, const char* path);

}  // namespace pd
