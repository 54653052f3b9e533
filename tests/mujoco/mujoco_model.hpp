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

/// What stands between <mujoco> and </mujoco> for a figure of 13 links and 20 hinges that stands on a plane, leans
/// forwards and has no motors: capsules, spheres and boxes.
inline std::string falling_humanoid() {
  const auto hinge = [](const char* axis, const char* range) {
    return "<joint type='hinge' axis='" + std::string(axis) + "' range='" + range + "' limited='true' damping='2'/>";
  };
  const auto leg = [&](const char* y) {
    return "<body pos='0 " + std::string(y) + " -.12'>" + hinge("1 0 0", "-25 25") + hinge("0 1 0", "-100 30") +
           "<geom type='capsule' size='.06' fromto='0 0 0 0 0 -.34'/><body pos='0 0 -.42'>" + hinge("0 1 0", "0 150") +
           "<geom type='capsule' size='.05' fromto='0 0 0 0 0 -.3'/><body pos='0 0 -.4'>" + hinge("0 1 0", "-45 45") +
           "<geom type='box' size='.11 .05 .03' pos='.05 0 0'/></body></body></body>";
  };
  const auto arm = [&](const char* y) {
    return "<body pos='0 " + std::string(y) + " .3'>" + hinge("0 1 0", "-150 60") + hinge("1 0 0", "-90 90") +
           "<geom type='capsule' size='.04' fromto='0 0 -.04 0 0 -.24'/><body pos='0 0 -.3'>" +
           hinge("0 1 0", "-140 0") +
           "<geom type='capsule' size='.035' fromto='0 0 0 0 0 -.2'/><geom type='sphere' size='.05' pos='0 0 -.26'/>" +
           "</body></body>";
  };
  return "<size nconmax='300' njmax='2000'/><option><flag energy='enable'/></option><worldbody>"
         "<geom type='plane' size='5 5 .1'/><body pos='0 0 .985' euler='0 6 0'><freejoint/>"
         "<geom type='box' size='.08 .13 .07'/>" +
         leg(".1") + leg("-.1") + "<body pos='0 0 .1'>" + hinge("0 1 0", "-30 45") + hinge("0 0 1", "-40 40") +
         "<geom type='capsule' size='.11' fromto='0 0 .06 0 0 .24'/><body pos='0 0 .42'>" + hinge("0 1 0", "-40 40") +
         hinge("1 0 0", "-30 30") + "<geom type='sphere' size='.1' pos='0 0 .06'/></body>" + arm(".2") + arm("-.2") +
         "</body></body></worldbody>";
}

/// Puts a geom somewhere as the kinematics would, and asks for the contacts.
inline void stand(mjData& data, int geom, const double position[3], const double wxyz[4]) {
  std::copy(position, position + 3, data.geom_xpos + 3 * geom);
  mju_quat2Mat(data.geom_xmat + 9 * geom, wxyz);
}

}  // namespace pd::test
