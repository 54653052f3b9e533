/// @file
/// MuJoCo models from text, for tests.
#pragma once

#include <mujoco/mujoco.h>

#include <cstring>
#include <memory>
#include <stdexcept>
#include <string>

namespace pd::test {

struct FreeMujoco {
  void operator()(mjModel* model) const { mj_deleteModel(model); }
  void operator()(mjData* data) const { mj_deleteData(data); }
};
using MujocoModel = std::unique_ptr<mjModel, FreeMujoco>;
using MujocoData = std::unique_ptr<mjData, FreeMujoco>;

/// @param body  what stands between <mujoco> and </mujoco>.
inline MujocoModel mujoco_model(const std::string& body) {
  const std::string text = "<mujoco>" + body + "</mujoco>";
  const auto files = std::make_unique<mjVFS>();
  mj_defaultVFS(files.get());
  mj_makeEmptyFileVFS(files.get(), "model.xml", static_cast<int>(text.size()));
  std::memcpy(files->filedata[0], text.data(), text.size());
  char error[1000] = "";
  mjModel* model = mj_loadXML("model.xml", files.get(), error, sizeof error);
  mj_deleteVFS(files.get());
  if (model == nullptr) throw std::runtime_error(error);
  return MujocoModel(model);
}

inline MujocoData mujoco_data(const MujocoModel& model) { return MujocoData(mj_makeData(model.get())); }

/// A world with two geoms of the given attributes, each on a free body; a plane stands still.
inline MujocoModel two_geoms(const std::string& first, const std::string& second, const std::string& assets = "") {
  const auto body = [](const std::string& geom) {
    return geom.find("plane") != std::string::npos ? "<geom " + geom + "/>"
                                                   : "<body><freejoint/><geom " + geom + "/></body>";
  };
  return mujoco_model("<size nconmax='100'/><asset>" + assets + "</asset><worldbody>" + body(first) + body(second) +
                      "</worldbody>");
}

/// Puts a geom somewhere as the kinematics would, and asks for the contacts.
inline void stand(mjData& data, int geom, const double position[3], const double wxyz[4]) {
  std::copy(position, position + 3, data.geom_xpos + 3 * geom);
  mju_quat2Mat(data.geom_xmat + 9 * geom, wxyz);
}

}  // namespace pd::test
