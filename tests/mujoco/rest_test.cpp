/// @file
/// MuJoCo worlds with pdepth's contacts: stacks, meshes and a grasp come to rest, and no energy comes from nowhere.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "mujoco/mujoco_model.hpp"
#include "pd/mujoco/install.hpp"

namespace pd {
namespace {

constexpr int kStepsOfASecond = 500;

class MujocoWorlds : public testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(install_mujoco()); }
  void TearDown() override { uninstall_mujoco(); }

  /// @param steps  of 2 ms, MuJoCo's own. @return the largest energy gained in a step.
  double run(const std::string& bodies, int steps) {
    model_ = test::mujoco_model("<size nconmax='300' njmax='1500'/><option><flag energy='enable'/></option>" + bodies);
    data_ = test::mujoco_data(model_);
    return run_loaded(steps);
  }
  double run_loaded(int steps) {
    double gained = 0, before = 0;
    for (int step = 0; step < steps; ++step) {
      mj_step(model_.get(), data_.get());
      const double energy = data_->energy[0] + data_->energy[1];
      if (step > 0) gained = std::max(gained, energy - before);
      before = energy;
    }
    return gained;
  }
  [[nodiscard]] double fastest() const {
    double speed = 0;
    for (int i = 0; i < model_->nv; ++i) speed = std::max(speed, std::abs(data_->qvel[i]));
    return speed;
  }

  test::MujocoModel model_;
  test::MujocoData data_;
};

TEST_F(MujocoWorlds, AStackOfBoxesStands) {
  std::string bodies = "<worldbody><geom type='plane' size='5 5 .1'/>";
  for (int i = 0; i < 5; ++i) {
    bodies += "<body pos='0 0 " + std::to_string(0.1 + 0.2 * i) + "' euler='0 0 " + std::to_string(7 * i) +
              "'><freejoint/><geom type='box' size='.1 .1 .1'/></body>";
  }
  const double gained = run(bodies + "</worldbody>", 4 * kStepsOfASecond);
  EXPECT_LT(fastest(), 1e-4);
  for (int i = 0; i < 5; ++i) {
    EXPECT_NEAR(data_->qpos[7 * i], 0, 1e-3);
    EXPECT_NEAR(data_->qpos[7 * i + 2], 0.1 + 0.2 * i, 0.01) << "soft contacts give way a little";
  }
  // 120 J of potential energy; the boxes sink into MuJoCo's soft contacts and come back once.
  EXPECT_LT(gained, 0.05);
}

TEST_F(MujocoWorlds, AMeshOnAPlaneComesToRest) {
  const std::string stone =
      "<asset><mesh name='m' vertex='-.1 -.1 -.1 .1 -.1 -.1 -.1 .1 -.1 .1 .1 -.1 -.05 -.05 .1 "
      ".05 -.05 .1 -.05 .05 .1 .05 .05 .1'/></asset>";
  run(stone +
          "<worldbody><geom type='plane' size='5 5 .1'/><body pos='0 0 .2' euler='20 10 0'><freejoint/>"
          "<geom type='mesh' mesh='m'/></body></worldbody>",
      3 * kStepsOfASecond);
  EXPECT_LT(fastest(), 1e-4);
  EXPECT_EQ(data_->ncon, 4) << "a face with four corners";
}

TEST_F(MujocoWorlds, RoundBodiesComeToRest) {
  run("<worldbody><geom type='plane' size='5 5 .1'/>"
      "<body pos='0 0 .12'><freejoint/><geom type='cylinder' size='.1 .1'/></body>"
      "<body pos='0 0 .33' euler='0 0 30'><freejoint/><geom type='cylinder' size='.1 .1'/></body>"
      "<body pos='1 0 .1' euler='90 0 0'><freejoint/><geom type='capsule' size='.1 .2'/></body></worldbody>",
      4 * kStepsOfASecond);
  // A capsule may roll on.
  for (int i = 0; i < 12; ++i) EXPECT_LT(std::abs(data_->qvel[i]), 1e-3);
  EXPECT_NEAR(data_->qpos[7 + 2], 0.3, 0.01);
  EXPECT_NEAR(data_->qpos[14 + 2], 0.1, 0.01);
}

TEST_F(MujocoWorlds, AHumanoidFallsAndLies) {
  model_ = test::mujoco_model(test::falling_humanoid());
  data_ = test::mujoco_data(model_);
  const double gained = run_loaded(10 * kStepsOfASecond);
  EXPECT_LT(data_->qpos[2], 0.3) << "the pelvis lies";
  EXPECT_LT(fastest(), 0.05);
  for (int i = 0; i < data_->ncon; ++i) EXPECT_GT(data_->contact[i].dist, -0.01) << "nothing is inside of another";
  EXPECT_LT(gained, 0.5);
}

TEST_F(MujocoWorlds, TwoFingersHoldABox) {
  const auto finger = [](const char* x, const char* axis) {
    return std::string("<body pos='") + x + " 0 .5'><joint name='" + axis[0] + "' type='slide' axis='" + axis +
           "' damping='20'/><geom type='box' size='.02 .05 .05' mass='.1' friction='1 .01 .001'/></body>";
  };
  run("<worldbody>" + finger("-.13", "1 0 0") + finger(".13", "-1 0 0") +
          "<body pos='0 0 .5'><freejoint/><geom type='box' size='.1 .04 .08' mass='.2' friction='1 .01 .001'/></body>"
          "</worldbody><actuator><motor joint='1'/><motor joint='-'/></actuator>",
      1);
  for (int step = 0; step < 2 * kStepsOfASecond; ++step) {
    data_->ctrl[0] = data_->ctrl[1] = 20;
    mj_step(model_.get(), data_.get());
  }
  EXPECT_NEAR(data_->qpos[2 + 2], 0.5, 0.03) << "the box has not slipped out (MuJoCo's soft friction creeps)";
}

}  // namespace
}  // namespace pd
