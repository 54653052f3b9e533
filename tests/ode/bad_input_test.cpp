/// @file
/// Bad input that ODE hands on: ODE's own function answers, and each reason is named once.
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "ode/ode_world.hpp"
#include "pd/ode/install.hpp"

namespace pd {
namespace {

using test::contacts_of;

class OdeBadInput : public testing::Test {
 protected:
  void SetUp() override {
    OdeOptions options;
    options.warning = [](const char* line, void* user) {
      static_cast<std::vector<std::string>*>(user)->emplace_back(line);
    };
    options.user = &lines_;
    ASSERT_TRUE(install_ode(options));
  }
  void TearDown() override {
    uninstall_ode();
    dGeomDestroy(ball_);
  }
  void expect_left(OdeRefusal kind, std::int64_t times, const std::string& words) {
    const OdeReport report = ode_report();
    const auto place = static_cast<std::size_t>(kind);
    EXPECT_EQ(report.left[place], times);
    ASSERT_EQ(lines_.size(), 1u) << "named once";
    EXPECT_NE(lines_[0].find(words), std::string::npos) << lines_[0];
    EXPECT_NE(lines_[0].find(report.first[place]), std::string::npos);
  }

  test::OdeLibrary library_;
  std::vector<std::string> lines_;
  dGeomID ball_ = dCreateSphere(nullptr, 0.5f);
};

TEST_F(OdeBadInput, PosesThatAreNone) {
  const dGeomID other = dCreateSphere(nullptr, 0.5f);
  for (const double x : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), 1e200}) {
    dGeomSetPosition(other, static_cast<dReal>(x), 0, 0);
    contacts_of(ball_, other);
  }
  expect_left(OdeRefusal::pose, 3, "a sphere of radius 0.5: its pose");
  dGeomDestroy(other);
}

TEST_F(OdeBadInput, GeomsWithoutSize) {
  const dGeomID plate = dCreateBox(nullptr, 1, 1, 1);
  dGeomBoxSetLengths(plate, 1, 1, 0);
  contacts_of(ball_, plate);
  contacts_of(ball_, plate);
  expect_left(OdeRefusal::size, 2, "a box of sides 1, 1, 0");
  dGeomDestroy(plate);
}

TEST_F(OdeBadInput, ConvexGeomsWhosePointsWereNotTold) {
  const test::OdeHull hull({{-0.5, -0.5, -0.5}, {0.5, -0.5, -0.5}, {0, 0.5, -0.5}, {0, 0, 0.5}});
  const dGeomID told = hull.geom(nullptr);
  EXPECT_FALSE(contacts_of(ball_, told).empty());
  EXPECT_EQ(ode_report().answered, 1);
  forget_ode_convex(told);
  EXPECT_FALSE(contacts_of(ball_, told).empty()) << "ODE's own answer";
  expect_left(OdeRefusal::convex, 1, "pd::ode_convex(geom, points, count)");
  dGeomDestroy(told);
}

TEST_F(OdeBadInput, PointsOfAnotherGeom) {
  const test::OdeHull hull({{-0.5, -0.5, -0.5}, {0.5, -0.5, -0.5}, {0, 0.5, -0.5}, {0, 0, 0.5}});
  const dGeomID geom = hull.geom(nullptr);
  test::place(geom, {0.1, 0.2, 0.3}, Eigen::AngleAxisd(0.5, Vec3::UnitX()).toRotationMatrix());
  contacts_of(ball_, geom);
  EXPECT_EQ(ode_report().answered, 1);
  std::vector<dReal> others = hull.points;
  others[2] -= 0.25f;
  ode_convex(geom, others.data(), hull.num_points);  // those of a geom that stood at the same address, say
  contacts_of(ball_, geom);
  expect_left(OdeRefusal::convex, 1, "its box is not that of the points");
  forget_ode_convex(geom);
  dGeomDestroy(geom);
}

}  // namespace
}  // namespace pd
