/// @file
/// MuJoCo's table of collision functions: what is replaced, and that it comes back bit for bit.
#include "pd/mujoco/install.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <limits>
#include <thread>
#include <vector>

#include "mujoco/mujoco_model.hpp"

namespace pd {
namespace {

using Table = std::array<unsigned char, sizeof mjCOLLISIONFUNC>;

Table table() {
  Table bytes;
  std::memcpy(bytes.data(), mjCOLLISIONFUNC, bytes.size());
  return bytes;
}

const std::string kBoxes = "type='box' size='.5 .5 .5'";

/// Two boxes of half a unit, the second a little higher and 0.125 deep in the first.
double depth_of_boxes(const test::MujocoModel& model, const test::MujocoData& data) {
  const double low[3] = {0, 0, 0}, high[3] = {0.1, 0.2, 0.875}, none[4] = {1, 0, 0, 0};
  test::stand(*data, 0, low, none);
  test::stand(*data, 1, high, none);
  mj_collision(model.get(), data.get());
  double depth = -1;
  for (int c = 0; c < data->ncon; ++c) depth = std::max(depth, -data->contact[c].dist);
  return depth;
}

TEST(MujocoInstall, TableComesBackBitForBit) {
  const Table before = table();
  const auto installed = install_mujoco();
  ASSERT_TRUE(installed);
  EXPECT_EQ(*installed, 27) << "six types on a plane, and twenty-one pairs of six types";
  EXPECT_NE(table(), before);
  EXPECT_NE(mjCOLLISIONFUNC[mjGEOM_BOX][mjGEOM_BOX], nullptr);
  ASSERT_TRUE(install_mujoco({.delta = 1e-3})) << "a second time: other options";
  uninstall_mujoco();
  EXPECT_EQ(table(), before);
  uninstall_mujoco();
  EXPECT_EQ(table(), before);
}

TEST(MujocoInstall, EntriesOfOthersStayTheirs) {
  const Table before = table();
  const mjfCollision own = mjCOLLISIONFUNC[mjGEOM_SPHERE][mjGEOM_SPHERE];
  const mjfCollision of_host = [](const auto*, auto*, auto*, int, int, mjtNum) { return 0; };
  mjCOLLISIONFUNC[mjGEOM_SPHERE][mjGEOM_BOX] = nullptr;  // the host wants no contacts of these
  const Table of_the_host = table();
  const auto installed = install_mujoco();
  ASSERT_TRUE(installed);
  EXPECT_EQ(*installed, 26);
  EXPECT_EQ(mjCOLLISIONFUNC[mjGEOM_SPHERE][mjGEOM_BOX], nullptr);
  uninstall_mujoco();
  EXPECT_EQ(table(), of_the_host);
  ASSERT_TRUE(install_mujoco());
  mjCOLLISIONFUNC[mjGEOM_SPHERE][mjGEOM_SPHERE] = of_host;  // after us
  uninstall_mujoco();
  EXPECT_EQ(mjCOLLISIONFUNC[mjGEOM_SPHERE][mjGEOM_SPHERE], of_host);
  mjCOLLISIONFUNC[mjGEOM_SPHERE][mjGEOM_SPHERE] = own;
  std::memcpy(mjCOLLISIONFUNC, before.data(), before.size());
}

TEST(MujocoInstall, AFunctionThatCallsOursIsNotCalledByIt) {
  const Table before = table();
  static mjfCollision ours = nullptr;
  ASSERT_TRUE(install_mujoco());
  ours = mjCOLLISIONFUNC[mjGEOM_BOX][mjGEOM_BOX];
  const mjfCollision above = [](const auto* model, auto* data, auto* contacts, int geom1, int geom2, mjtNum margin) {
    return ours(model, data, contacts, geom1, geom2, margin);
  };
  mjCOLLISIONFUNC[mjGEOM_BOX][mjGEOM_BOX] = above;
  MujocoOptions options;
  options.takes_pair = [](const mjModel*, int, int, void*) { return false; };
  const auto again = install_mujoco(options);
  ASSERT_TRUE(again);
  EXPECT_EQ(*again, 26);
  EXPECT_EQ(mjCOLLISIONFUNC[mjGEOM_BOX][mjGEOM_BOX], above);
  const auto model = test::two_geoms(kBoxes, kBoxes);
  const auto data = test::mujoco_data(model);
  EXPECT_GT(depth_of_boxes(model, data), 0) << "MuJoCo's own answer";
  mjCOLLISIONFUNC[mjGEOM_BOX][mjGEOM_BOX] = ours;
  uninstall_mujoco();
  EXPECT_EQ(table(), before);
}

TEST(MujocoInstall, OptionsAreChecked) {
  const Table before = table();
  for (const double delta : {-1e-9, 1.5, std::numeric_limits<double>::quiet_NaN()}) {
    const auto installed = install_mujoco({.delta = delta});
    ASSERT_FALSE(installed);
    EXPECT_EQ(installed.error().where, "delta");
  }
  EXPECT_EQ(table(), before);
}

TEST(MujocoInstall, PairsThatAreNotTakenAreMujocos) {
  const auto model = test::two_geoms(kBoxes, kBoxes);
  const auto data = test::mujoco_data(model);
  MujocoOptions options;
  options.takes_pair = [](const mjModel*, int geom1, int geom2, void*) { return geom1 != 0 || geom2 != 1; };
  ASSERT_TRUE(install_mujoco(options));
  depth_of_boxes(model, data);
  EXPECT_EQ(mujoco_report().answered, 0);
  ASSERT_TRUE(install_mujoco());
  EXPECT_NEAR(depth_of_boxes(model, data), 0.125, 1e-12);
  EXPECT_EQ(mujoco_report().answered, 1);
  EXPECT_EQ(mujoco_report().contact_points, 4);
  uninstall_mujoco();
}

TEST(MujocoInstall, ChangedGeomsAreConvertedAgain) {
  ASSERT_TRUE(install_mujoco());
  const std::string mesh =
      "<mesh name='m' vertex='-.5 -.5 -.5 .5 -.5 -.5 -.5 .5 -.5 .5 .5 -.5 -.5 -.5 .5 .5 -.5 .5 "
      "-.5 .5 .5 .5 .5 .5'/>";
  for (const std::string& geom : {kBoxes, std::string("type='mesh' mesh='m'")}) {
    const auto model = test::two_geoms(geom, geom, mesh);
    const auto data = test::mujoco_data(model);
    EXPECT_NEAR(depth_of_boxes(model, data), 0.125, 1e-7);
    const std::int64_t conversions = mujoco_report().conversions;
    EXPECT_NEAR(depth_of_boxes(model, data), 0.125, 1e-7);
    EXPECT_EQ(mujoco_report().conversions, conversions);
    model->geom_size[3 + 2] += 0.0625;  // in place, while the model lives
    for (int i = 0; i < 3 * model->nmeshvert; ++i) model->mesh_vert[i] *= 1.0625f;
    EXPECT_NEAR(depth_of_boxes(model, data), geom == kBoxes ? 0.1875 : 0.1875, 1e-7);
    EXPECT_GT(mujoco_report().conversions, conversions);
  }
  uninstall_mujoco();
}

TEST(MujocoInstall, ThreadsGetTheSameBits) {
  std::string bodies = "<geom type='plane' size='5 5 .1'/>";
  const char* kinds[] = {"type='box' size='.1 .1 .1'", "type='cylinder' size='.1 .1'", "type='capsule' size='.08 .1'",
                         "type='ellipsoid' size='.1 .12 .08'", "type='sphere' size='.1'"};
  for (int i = 0; i < 20; ++i) {
    bodies += "<body pos='" + std::to_string(0.05 * (i % 3)) + " " + std::to_string(0.03 * (i % 4)) + " " +
              std::to_string(0.15 + 0.17 * i) + "'><freejoint/><geom " + kinds[i % 5] + "/></body>";
  }
  const auto model = test::mujoco_model("<size nconmax='500' njmax='2000'/><worldbody>" + bodies + "</worldbody>");
  const auto run = [&](std::vector<mjtNum>& end) {
    const auto data = test::mujoco_data(model);
    for (int step = 0; step < 150; ++step) mj_step(model.get(), data.get());
    end.assign(data->qpos, data->qpos + model->nq);
  };
  ASSERT_TRUE(install_mujoco());  // the report starts after MuJoCo's compiler has asked for contacts
  std::vector<mjtNum> alone, together[2];
  run(alone);
  std::thread threads[2];
  for (int i = 0; i < 2; ++i) threads[i] = std::thread([&run, &end = together[i]] { run(end); });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(together[0], alone);
  EXPECT_EQ(together[1], alone);
  const MujocoReport report = mujoco_report();
  EXPECT_EQ(report.answered % 3, 0) << "what threads counted that have ended is still there";
  EXPECT_GT(report.answered, 0);
  uninstall_mujoco();
}

}  // namespace
}  // namespace pd
