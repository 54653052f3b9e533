/// @file
/// Contacts in ODE, pair of classes by pair of classes, against exact answers of the core for bodies that are built
/// here.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "ode/ode_world.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "pd/ode/install.hpp"

namespace pd {
namespace {

const char* const kNames[] = {"sphere", "box", "capsule", "cylinder", "plane", "convex"};
constexpr int kPlane = 4, kCylinder = 3;

/// Twelve points on a ball.
const std::vector<Vec3>& stone() {
  static const std::vector<Vec3> points = [] {
    std::mt19937 random(5);
    std::normal_distribution<double> normal;
    std::vector<Vec3> made;
    for (int i = 0; i < 12; ++i)
      made.push_back(0.5 * Vec3{normal(random), normal(random), normal(random)}.normalized());
    return made;
  }();
  return points;
}

ConvexShape body_of(int kind) {
  switch (kind) {
    case 0:
      return *ConvexShape::sphere(0.4);
    case 1:
      return *ConvexPolytope::box({0.3, 0.4, 0.5});
    case 2:
      return *ConvexShape::capsule(0.2, 0.4, 2);
    case kCylinder:
      return *ConvexShape::cylinder(0.3, 0.4, 2);
    case kPlane:  // as thick and wide as no geom here reaches
      return *ConvexPolytope::from_points(std::vector<Vec3>{{-64, -64, -64},
                                                            {64, -64, -64},
                                                            {-64, 64, -64},
                                                            {64, 64, -64},
                                                            {-64, -64, 0},
                                                            {64, -64, 0},
                                                            {-64, 64, 0},
                                                            {64, 64, 0}});
    default:
      return *ConvexPolytope::from_points(stone());
  }
}

class OdePairs : public testing::TestWithParam<std::pair<int, int>> {
 protected:
  void SetUp() override { ASSERT_TRUE(install_ode({.delta = 1e-9})); }
  void TearDown() override { uninstall_ode(); }
  dGeomID geom_of(int kind) {
    switch (kind) {
      case 0:
        return dCreateSphere(nullptr, 0.4);
      case 1:
        return dCreateBox(nullptr, 0.6, 0.8, 1);
      case 2:
        return dCreateCapsule(nullptr, 0.2, 0.8);
      case kCylinder:
        return dCreateCylinder(nullptr, 0.3, 0.8);
      case kPlane:
        return dCreatePlane(nullptr, 0, 0, 1, 0);
      default:
        return hull_.geom(nullptr);
    }
  }
  /// A pose 0.4 units around the origin; a plane stays.
  Pose place(dGeomID geom, int kind) {
    if (kind == kPlane) return Pose();
    const Vec3 at = 0.4 * Vec3{normal_(random_), normal_(random_), normal_(random_)};
    const Eigen::Quaterniond turn{normal_(random_), normal_(random_), normal_(random_), normal_(random_)};
    test::place(geom, at, turn.normalized().toRotationMatrix());
    return *Pose::from_matrix(turn.normalized().toRotationMatrix(), at);
  }

  test::OdeLibrary library_;
  test::OdeHull hull_{stone()};
  std::mt19937 random_{11};
  std::normal_distribution<double> normal_;
  Scratch scratch_;
};

TEST_P(OdePairs, ContactsAreExact) {
  const auto [first, second] = GetParam();
  const dGeomID a = geom_of(first), b = geom_of(second);
  const ConvexShape body_a = body_of(first), body_b = body_of(second);
  int met = 0, apart = 0;
  for (int trial = 0; trial < 40 && !HasFailure(); ++trial) {
    const Pose pose_a = place(a, first), pose_b = place(b, second);
    const PenetrationDepth exact = penetration_depth({&body_a, pose_a}, {&body_b, pose_b}, scratch_, {.delta = 1e-9});
    const double x = exact.signed_distance(), slack = 1e-8 * std::abs(x) + 1e-12;
    const auto contacts = test::contacts_of(a, b);
    if (std::abs(x) > slack) {
      EXPECT_EQ(!contacts.empty(), x < 0) << trial;
    }
    (contacts.empty() ? apart : met)++;
    if (contacts.empty()) continue;
    EXPECT_NEAR(contacts[0].depth, -x, slack) << "the deepest point comes first and shows the depth";
    for (const dContactGeom& contact : contacts) {
      EXPECT_EQ(contact.g1, a);
      EXPECT_EQ(contact.g2, b);
      EXPECT_LE(contact.depth, -x + slack);
      // The normal leads the first geom out of the second by the shortest way.
      const Vec3 normal(contact.normal);
      EXPECT_NEAR(normal.norm(), 1, 1e-12);
      const Pose moved = *Pose::from_matrix(pose_a.rotation(), pose_a.translation() - x * normal);
      const PenetrationDepth left = penetration_depth({&body_a, moved}, {&body_b, pose_b}, scratch_);
      EXPECT_NEAR(left.signed_distance(), 0, 1e-5) << "a curved body's normal is as exact as the root of its depth";
    }
  }
  EXPECT_GE(met, 4);
  EXPECT_GE(apart, first == kPlane || second == kPlane ? 3 : 1);
  EXPECT_EQ(ode_report().answered, met + apart);
  EXPECT_EQ(ode_report().left, (std::array<std::int64_t, kOdeRefusals>{}));
  for (const dGeomID geom : {a, b}) {
    forget_ode_convex(geom);
    dGeomDestroy(geom);
  }
}

std::vector<std::pair<int, int>> all_pairs() {
  std::vector<std::pair<int, int>> pairs;
  for (int i = 0; i < 6; ++i) {
    for (int j = i; j < 6; ++j) {
      if (i != kPlane || j != kPlane) pairs.emplace_back(i, j);
    }
  }
  pairs.emplace_back(kPlane, 1);
  return pairs;
}

INSTANTIATE_TEST_SUITE_P(Ode, OdePairs, testing::ValuesIn(all_pairs()), [](const auto& pair) {
  return std::string(kNames[pair.param.first]) + "_" + kNames[pair.param.second];
});

}  // namespace
}  // namespace pd
