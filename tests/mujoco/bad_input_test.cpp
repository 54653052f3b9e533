/// @file
/// Bad input that MuJoCo hands on: MuJoCo's own function answers, and each reason is named once.
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "mujoco/mujoco_model.hpp"
#include "pd/mujoco/install.hpp"

namespace pd {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

class MujocoBadInput : public testing::Test {
 protected:
  /// Installs after loading: MuJoCo's compiler asks for contacts, too.
  void install() {
    MujocoOptions options;
    options.warning = [](const char* line, void* user) {
      static_cast<std::vector<std::string>*>(user)->emplace_back(line);
    };
    options.user = &lines_;
    ASSERT_TRUE(install_mujoco(options));
  }
  void TearDown() override { uninstall_mujoco(); }

  void load(const std::string& first, const std::string& second, const std::string& assets = "") {
    model_ = test::two_geoms(first, second, assets);
    data_ = test::mujoco_data(model_);
    mj_kinematics(model_.get(), data_.get());
    install();
  }
  /// Calls what stands in the table, as MuJoCo's driver would.
  int collide() {
    std::vector<mjContact> contacts(mjMAXCONPAIR);
    return mjCOLLISIONFUNC[model_->geom_type[0]][model_->geom_type[1]](model_.get(), data_.get(), contacts.data(), 0, 1,
                                                                       0);
  }
  void expect_left(MujocoRefusal kind, std::int64_t times, const std::string& words) {
    const auto report = mujoco_report();
    const auto place = static_cast<std::size_t>(kind);
    EXPECT_EQ(report.left[place], times);
    EXPECT_EQ(report.answered, 0);
    ASSERT_EQ(lines_.size(), 1u) << "named once";
    EXPECT_NE(lines_[0].find(words), std::string::npos) << lines_[0];
    EXPECT_NE(lines_[0].find(report.first[place]), std::string::npos);
  }

  std::vector<std::string> lines_;
  test::MujocoModel model_;
  test::MujocoData data_;
};

const std::string kBall = "name='ball' type='sphere' size='.5'";
const std::string kStone = "<mesh name='m' vertex='0 0 0 1 0 0 0 1 0 0 0 1'/>";

TEST_F(MujocoBadInput, PosesThatAreNoRotations) {
  load(kBall, "type='sphere' size='.5'");
  data_->geom_xpos[1] = kNaN;
  for (int i = 0; i < 3; ++i) collide();
  data_->geom_xpos[1] = 1e200;
  collide();
  data_->geom_xpos[1] = 0;
  data_->geom_xmat[4] = std::numeric_limits<double>::infinity();
  collide();
  std::fill(data_->geom_xmat, data_->geom_xmat + 9, 0.0);
  collide();
  expect_left(MujocoRefusal::pose, 6, "geom 0 (\"ball\", sphere)");
}

TEST_F(MujocoBadInput, GeomsWithoutSize) {
  load("type='box' size='.5 .5 .5'", "name='plate' type='box' size='.5 .5 .5'");
  for (const double size : {0.0, -1.0, kNaN, 1e200}) {
    model_->geom_size[3 + 2] = size;
    EXPECT_GE(collide(), 0);
  }
  expect_left(MujocoRefusal::size, 4, "geom 1 (\"plate\", box), geom_size");
}

TEST_F(MujocoBadInput, MeshesThatAreNone) {
  load("type='plane' size='1 1 .1'", "name='stone' type='mesh' mesh='m'", kStone);
  model_->mesh_vert[2] = std::numeric_limits<float>::quiet_NaN();
  collide();
  expect_left(MujocoRefusal::mesh, 1, "geom 1 (\"stone\", mesh), mesh_vert");
}

TEST_F(MujocoBadInput, FlatMeshesAreBodies) {
  load("type='plane' size='1 1 .1'", "type='mesh' mesh='m'", kStone);
  for (int v = 0; v < model_->nmeshvert; ++v) model_->mesh_vert[3 * v + 2] = 0;  // a triangle
  const double low[3] = {0, 0, -0.25}, none[4] = {1, 0, 0, 0};
  test::stand(*data_, 1, low, none);
  EXPECT_GE(collide(), 1);
  EXPECT_EQ(mujoco_report().answered, 1);
  EXPECT_TRUE(lines_.empty());
}

}  // namespace
}  // namespace pd
