/// @file
/// Contacts in MuJoCo, pair of shapes by pair of shapes, against exact answers of the core for bodies that are built
/// here.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "mujoco/mujoco_model.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "pd/mujoco/install.hpp"

namespace pd {
namespace {

constexpr double kMargin = 0.05;

struct NamedGeom {
  const char* name;
  std::string attributes;
  bool curved;
};

/// Twelve points about a ball: written into the model, and read back from it in single precision.
std::string mesh_asset() {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  std::string text = "<mesh name='stone' vertex='";
  for (int i = 0; i < 12; ++i) {
    const Vec3 p = 0.5 * Vec3{normal(random), normal(random), normal(random)}.normalized();
    text += std::to_string(p.x()) + " " + std::to_string(p.y()) + " " + std::to_string(p.z()) + " ";
  }
  return text + "'/>";
}

std::vector<NamedGeom> geoms() {
  return {{"plane", "type='plane' size='1 1 .1'", false},     {"sphere", "type='sphere' size='.4'", false},
          {"capsule", "type='capsule' size='.2 .4'", false},  {"ellipsoid", "type='ellipsoid' size='.3 .5 .4'", true},
          {"cylinder", "type='cylinder' size='.3 .4'", true}, {"box", "type='box' size='.3 .4 .5'", false},
          {"mesh", "type='mesh' mesh='stone'", false}};
}

ConvexShape body_of(const mjModel& model, int geom) {
  const mjtNum* size = model.geom_size + 3 * geom;
  switch (model.geom_type[geom]) {
    case mjGEOM_PLANE: {  // as thick and wide as no geom here reaches
      std::vector<Vec3> corners;
      for (int i = 0; i < 8; ++i) corners.emplace_back((i & 1) ? 64 : -64, (i & 2) ? 64 : -64, (i & 4) ? 0 : -64);
      return *ConvexPolytope::from_points(corners);
    }
    case mjGEOM_SPHERE:
      return *ConvexShape::sphere(size[0]);
    case mjGEOM_CAPSULE:
      return *ConvexShape::capsule(size[0], size[1], 2);
    case mjGEOM_ELLIPSOID:
      return *ConvexShape::ellipsoid({size[0], size[1], size[2]});
    case mjGEOM_CYLINDER:
      return *ConvexShape::cylinder(size[0], size[1], 2);
    case mjGEOM_BOX:
      return *ConvexPolytope::box({size[0], size[1], size[2]});
    default: {
      std::vector<Vec3> points;
      for (int i = 0; i < model.nmeshvert; ++i) {
        points.emplace_back(model.mesh_vert[3 * i], model.mesh_vert[3 * i + 1], model.mesh_vert[3 * i + 2]);
      }
      return *ConvexPolytope::from_points(points);
    }
  }
}

Pose pose_of(const mjData& data, int geom) {
  Mat3 rotation;
  for (int i = 0; i < 9; ++i) rotation(i / 3, i % 3) = data.geom_xmat[9 * geom + i];
  return *Pose::from_matrix(rotation, Vec3(data.geom_xpos + 3 * geom));
}

class Pairs : public testing::TestWithParam<std::pair<std::size_t, std::size_t>> {
 protected:
  void SetUp() override { ASSERT_TRUE(install_mujoco()); }
  void TearDown() override { uninstall_mujoco(); }

  /// Two bodies about a third of their size apart, in any orientation.
  void place(mjData& data, bool plane) {
    for (int geom = plane ? 1 : 0; geom < 2; ++geom) {
      const double position[3] = {0.4 * normal_(random_), 0.4 * normal_(random_), 0.4 * normal_(random_)};
      double wxyz[4] = {normal_(random_), normal_(random_), normal_(random_), normal_(random_)};
      mju_normalize4(wxyz);
      test::stand(data, geom, position, wxyz);
    }
  }

  std::mt19937 random_{11};
  std::normal_distribution<double> normal_;
  Scratch scratch_;
};

/// Checks that all contacts of one pair mean what MuJoCo means by a contact.
void check_contacts(const mjModel& model, const mjData& data, const PenetrationDepth& exact, double slack) {
  const ConvexShape body[2] = {body_of(model, 0), body_of(model, 1)};
  const ConvexShape point = *ConvexPolytope::from_points(std::vector<Vec3>{Vec3::Zero()});
  const double x = exact.signed_distance();
  Scratch scratch;
  double nearest = kMargin;
  for (int c = 0; c < data.ncon; ++c) {
    const mjContact& contact = data.contact[c];
    const Vec3 normal(contact.frame), middle(contact.pos);
    nearest = std::min(nearest, contact.dist);
    EXPECT_NEAR(normal.norm(), 1, 1e-12);
    EXPECT_GE(contact.dist, x - slack) << "no point is deeper than the bodies are";
    // The normal leads from the first geom to the second, and out of it by the shortest way.
    const Pose moved = *Pose::from_matrix(pose_of(data, 1).rotation(), pose_of(data, 1).translation() - x * normal);
    const PenetrationDepth left = penetration_depth({&body[0], pose_of(data, 0)}, {&body[1], moved}, scratch);
    EXPECT_NEAR(left.signed_distance(), 0, 100 * slack + 1e-9);
    // The position is midway between the two surfaces.
    const Vec3 ends[2] = {middle - contact.dist / 2 * normal, middle + contact.dist / 2 * normal};
    for (int side = 0; side < 2; ++side) {
      const Pose at = *Pose::from_matrix(Mat3::Identity(), ends[side]);
      const PenetrationDepth outside = penetration_depth({&point, at}, {&body[side], pose_of(data, side)}, scratch);
      EXPECT_LE(outside.distance, 1e-3) << "a corner of a disc's sixteen, at worst";
    }
  }
  if (data.ncon > 0) {
    EXPECT_NEAR(nearest, x, slack) << "the deepest point shows the depth";
  }
}

TEST_P(Pairs, ContactsAreExact) {
  const NamedGeom first = geoms()[GetParam().first], second = geoms()[GetParam().second];
  const std::string margin = " margin='" + std::to_string(kMargin) + "'";
  const auto model = test::two_geoms(first.attributes + margin, second.attributes + margin, mesh_asset());
  const auto data = test::mujoco_data(model);
  mj_kinematics(model.get(), data.get());
  const ConvexShape body[2] = {body_of(*model, 0), body_of(*model, 1)};
  int met = 0, apart = 0;
  for (int trial = 0; trial < 60 && !HasFailure(); ++trial) {
    place(*data, GetParam().first == 0);
    const PenetrationDepth exact = penetration_depth({&body[0], pose_of(*data, 0)}, {&body[1], pose_of(*data, 1)},
                                                     scratch_, {.delta = first.curved || second.curved ? 1e-9 : 0});
    mj_collision(model.get(), data.get());
    const double x = exact.signed_distance();
    const double slack = (first.curved || second.curved ? 1e-6 * std::abs(x) : 0) + 1e-12;
    if (std::abs(x - kMargin) > slack) {
      EXPECT_EQ(data->ncon > 0, x < kMargin) << "trial " << trial;
    }
    check_contacts(*model, *data, exact, slack);
    (data->ncon > 0 ? met : apart)++;
  }
  EXPECT_GE(met, 4);
  EXPECT_GE(apart, 4);
  const MujocoReport report = mujoco_report();
  EXPECT_GT(report.answered, met - 1);
  EXPECT_EQ(report.left, (std::array<std::int64_t, kMujocoRefusals>{}));
}

std::vector<std::pair<std::size_t, std::size_t>> all_pairs() {
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (std::size_t i = 0; i < geoms().size(); ++i) {
    for (std::size_t j = std::max<std::size_t>(i, 1); j < geoms().size(); ++j) pairs.emplace_back(i, j);
  }
  return pairs;
}

INSTANTIATE_TEST_SUITE_P(Mujoco, Pairs, testing::ValuesIn(all_pairs()), [](const auto& pair) {
  return std::string(geoms()[pair.param.first].name) + "_" + geoms()[pair.param.second].name;
});

/// These numbers were computed by hand.
TEST(MujocoPairs, KnownContacts) {
  ASSERT_TRUE(install_mujoco());
  const double none[4] = {1, 0, 0, 0};
  const auto deepest = [&](const std::string& first, const std::string& second, double z) {
    const auto model = test::two_geoms(first, second);
    const auto data = test::mujoco_data(model);
    const double low[3] = {0, 0, 0}, high[3] = {0, 0, z};
    test::stand(*data, 0, low, none);
    test::stand(*data, 1, high, none);
    mj_collision(model.get(), data.get());
    double dist = 1;
    for (int c = 0; c < data->ncon; ++c) {
      dist = std::min(dist, data->contact[c].dist);
      EXPECT_NEAR(data->contact[c].frame[2], 1, 1e-7) << first << " " << second;
    }
    return dist;
  };
  const std::string plane = "type='plane' size='1 1 .1'", ball = "type='sphere' size='.5'",
                    box = "type='box' size='1 1 .25'", rod = "type='cylinder' size='.5 .25'",
                    pill = "type='capsule' size='.25 .5'", egg = "type='ellipsoid' size='.3 .4 .5'";
  EXPECT_NEAR(deepest(plane, ball, 0.375), -0.125, 1e-14);
  EXPECT_NEAR(deepest(plane, box, 0.125), -0.125, 1e-14);
  EXPECT_NEAR(deepest(plane, rod, 0.125), -0.125, 1e-14);
  EXPECT_NEAR(deepest(plane, pill, 0.5), -0.25, 1e-14);
  EXPECT_NEAR(deepest(plane, egg, 0.25), -0.25, 1e-7);
  EXPECT_NEAR(deepest(ball, box, 0.625), -0.125, 1e-14);
  EXPECT_NEAR(deepest(box, box, 0.375), -0.125, 1e-14);
  EXPECT_NEAR(deepest(rod, box, 0.375), -0.125, 1e-7);
  EXPECT_NEAR(deepest(rod, rod, 0.4375), -0.0625, 1e-7);
  uninstall_mujoco();
}

}  // namespace
}  // namespace pd
