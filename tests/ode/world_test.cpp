/// @file
/// ODE worlds with pdepth's contacts: a stack stands, a vehicle drives, a heap comes to rest; and records of them.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <string>

#include "ode/ode_world.hpp"
#include "pd/ode/contact_recorder.hpp"
#include "pd/ode/install.hpp"

namespace pd {
namespace {

class OdeWorlds : public testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(install_ode()); }
  void TearDown() override { uninstall_ode(); }

  test::OdeLibrary library_;
};

TEST_F(OdeWorlds, AStackStands) {
  test::OdeWorld world;
  dCreatePlane(world.space(), 0, 0, 1, 0);
  for (int i = 0; i < 6; ++i) {
    world.box({0.4, 0.4, 0.4}, {0, 0, 0.2 + 0.4 * i}, Eigen::AngleAxisd(0.1 * i, Vec3::UnitZ()).toRotationMatrix());
  }
  for (int step = 0; step < 500; ++step) world.step(0.01);
  EXPECT_LT(world.fastest(), 1e-2);
  for (std::size_t i = 0; i < 6; ++i) {
    const Vec3 at = test::OdeWorld::position(world.bodies()[i]);
    EXPECT_NEAR(at.head<2>().norm(), 0, 1e-2);
    EXPECT_NEAR(at.z(), 0.2 + 0.4 * static_cast<double>(i), 5e-3) << "soft contacts give way a little";
  }
}

TEST_F(OdeWorlds, AVehicleDrives) {
  test::OdeWorld world;
  dCreatePlane(world.space(), 0, 0, 1, 0);
  const dBodyID chassis = test::drive_vehicle(world, Vec3::Zero(), 5);
  for (int step = 0; step < 400; ++step) world.step(0.01);
  const Vec3 at = test::OdeWorld::position(chassis);
  EXPECT_GT(std::abs(at.x()), 2.5) << "wheels of 0.2 turn by 5 radians a second for 4 seconds";
  EXPECT_LT(std::abs(at.x()), 4.0 + 0.1);
  EXPECT_NEAR(at.y(), 0, 0.05);
  EXPECT_NEAR(at.z(), 0.35, 0.03);
}

TEST_F(OdeWorlds, HullsComeToRest) {
  test::OdeWorld world;
  dCreatePlane(world.space(), 0, 0, 1, 0);
  const test::OdeHull& hull = world.keep({{-0.2, -0.2, -0.1}, {0.2, -0.2, -0.1}, {0, 0.2, -0.1}, {0, 0, 0.2}});
  for (int i = 0; i < 3; ++i) world.body(hull.geom(world.space()), {0.5 * i, 0, 0.15}, {0.3, 0.3, 0.3});
  for (int step = 0; step < 200; ++step) world.step(0.01);
  EXPECT_LT(world.fastest(), 1e-3);
  EXPECT_EQ(world.contacts_of_step(), 9) << "three corners each";
  EXPECT_EQ(ode_report().left, (std::array<std::int64_t, kOdeRefusals>{}));
}

std::string whole_file(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

int count_of(const std::string& text, const std::string& word) {
  int count = 0;
  for (auto at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++count;
  return count;
}

TEST_F(OdeWorlds, ARecordOfOneStateAndOfARun) {
  test::OdeWorld world;
  dCreatePlane(world.space(), 0, 0, 1, 0);
  world.box({1, 1, 0.5}, {0, 0, 0.24});
  world.box({1, 1, 0.5}, {0, 0, 0.73});
  world.body(dCreateCapsule(world.space(), 0.1, 0.2), {0.55, 0.55, 0.36}, {0.2, 0.2, 0.4},
             Eigen::AngleAxisd(0.8, Vec3(1, 1, 0).normalized()).toRotationMatrix());
  const std::string path = testing::TempDir() + "ode_state.jsonl";
  for (const bool ours : {true, false}) {
    if (!ours) uninstall_ode();
    ASSERT_TRUE(record_ode(world.space(), path.c_str()));
    const std::string text = whole_file(path);
    EXPECT_NE(text.find("\"engine\":\"ODE\""), std::string::npos);
    EXPECT_EQ(count_of(text, "{\"shape\":"), 3) << "two boxes of one size are one shape: " << text;
    EXPECT_EQ(count_of(text, "\"reported\":{\"depth\":0.01"), 2) << text;
    EXPECT_GE(count_of(text, "\"reported\":null"), 1) << "the capsule and a box were looked at";
  }
  EXPECT_FALSE(record_ode(world.space(), "/nowhere/contacts.jsonl"));
  {
    OdeRecorder recorder(path.c_str());
    ASSERT_TRUE(recorder.good());
    EXPECT_FALSE(OdeRecorder(path.c_str()).good()) << "one recorder at a time";
    ASSERT_TRUE(install_ode()) << "meanwhile";
    for (int step = 0; step < 5; ++step) {
      recorder.set_time(0.01 * step);
      world.step(0.01);
    }
    EXPECT_GT(recorder.contacts(), 10);
    EXPECT_EQ(recorder.contacts(), ode_report().answered);
    dGeomSetPosition(dBodyGetFirstGeom(world.bodies()[2]), std::nan(""), 0, 0);
    dCollide(dBodyGetFirstGeom(world.bodies()[2]), dBodyGetFirstGeom(world.bodies()[0]), 1,
             std::array<dContactGeom, 1>{}.data(), sizeof(dContactGeom));
    EXPECT_EQ(recorder.unsupported(), 1);
    EXPECT_TRUE(recorder.close());
    EXPECT_TRUE(recorder.close());
  }
  EXPECT_NE(whole_file(path).find("\"time\":0.04"), std::string::npos);
  std::remove(path.c_str());
}

}  // namespace
}  // namespace pd
