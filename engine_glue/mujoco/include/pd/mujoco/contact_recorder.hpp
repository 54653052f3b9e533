/// @file
/// Records MuJoCo's contacts for `pdepth audit`: what its narrow phase says of each pair, whoever answers.
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

/// Records while it lives: functions of ours stand in MuJoCo's table meanwhile, and hand every call on to those that
/// stood there, MuJoCo's own or those of `install_mujoco`. Begin and end it while no thread is inside MuJoCo, and end
/// it before what it stands on is uninstalled.
///
/// A line is written for every pair of convex geoms, and of one and a plane, that the narrow phase is asked about for
/// this model: `null` where it answers with no contact. Reported is the deepest point with its normal; all points
/// follow. A is MuJoCo's first geom. Poses are those of the question, and the time that of its `mjData`.
///
/// Not written, but counted as `unsupported`: geoms that have no exact shape (bad sizes, poses that are no rotations).
/// Height fields and soft bodies are not seen. Threads are served one at a time.
class MujocoRecorder {
 public:
  /// Creates the file. @param model  must outlive the recorder, and has no other recorder (else `good` is false).
  MujocoRecorder(const mjModel* model, const char* path);
  ~MujocoRecorder();
  MujocoRecorder(const MujocoRecorder&) = delete;
  MujocoRecorder& operator=(const MujocoRecorder&) = delete;

  /// Ends the recording and closes the file; false where something could not be written. May be called once more.
  bool close();

  [[nodiscard]] bool good() const;
  [[nodiscard]] std::int64_t contacts() const;     ///< lines written
  [[nodiscard]] std::int64_t unsupported() const;  ///< pairs that could not be

 private:
  std::unique_ptr<detail::RecordedModel> model_;
};

/// The contacts of one state, in one call: those that MuJoCo finds for the poses in `data`, which stays as it is.
/// @return false where the file cannot be written, or the model is being recorded.
bool record_mujoco(const mjModel* model, const mjData* data, const char* path);

}  // namespace pd
