/// @file
/// Pairs whose depth a person can work out.

#include <gtest/gtest.h>

#include <cmath>

#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "scenes/shape_families.hpp"

namespace pd {
namespace {

Pose at(double x, double y, double z) { return *Pose::from_matrix(Mat3::Identity(), Vec3(x, y, z)); }
ConvexShape box(double x, double y, double z) { return ConvexShape(*ConvexPolytope::box(Vec3(x, y, z))); }

PenetrationDepth solve(const ConvexShape& a, const Pose& pose_a, const ConvexShape& b, const Pose& pose_b) {
  Scratch scratch;
  return penetration_depth({&a, pose_a}, {&b, pose_b}, scratch);
}

TEST(AnalyticDepth, UnitCubesSideBySide) {
  const ConvexShape cube = box(0.5, 0.5, 0.5);
  const PenetrationDepth d = solve(cube, at(0, 0, 0), cube, at(0.75, 0, 0));
  EXPECT_EQ(d.contact, ContactClass::overlapping);
  EXPECT_EQ(d.lower, 0.25);
  EXPECT_EQ(d.upper, 0.25);
  EXPECT_EQ(d.depth, 0.25);
  EXPECT_EQ(d.translation, Vec3(-0.25, 0, 0));  // A moves away from B
  EXPECT_EQ(d.normal, Vec3(-1, 0, 0));
  EXPECT_EQ(d.distance, 0);
}

TEST(AnalyticDepth, UnitCubesTouchAtFaceEdgeAndCorner) {
  const ConvexShape cube = box(0.5, 0.5, 0.5);
  for (const Vec3& t : {Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(-1, 1, 1), Vec3(0.25, -0.5, 1)}) {
    const PenetrationDepth d = solve(cube, at(0, 0, 0), cube, at(t.x(), t.y(), t.z()));
    EXPECT_EQ(d.contact, ContactClass::touching) << t.transpose();
    EXPECT_EQ(d.depth, 0);
    EXPECT_EQ(d.lower, 0);
    EXPECT_EQ(d.upper, 0);
    EXPECT_EQ(d.distance, 0);
    EXPECT_LE((d.witness_a - d.witness_b).norm(), 1e-15);
    EXPECT_LE(d.normal.dot(t), 0) << "A leaves away from B";
  }
}

TEST(AnalyticDepth, UnitCubesApart) {
  const ConvexShape cube = box(0.5, 0.5, 0.5);
  const PenetrationDepth d = solve(cube, at(0, 0, 0), cube, at(4, 5, 0));
  EXPECT_EQ(d.contact, ContactClass::separated);
  EXPECT_EQ(d.distance, 5);
  EXPECT_EQ(d.depth, 0);
  EXPECT_LE((d.normal - Vec3(-0.6, -0.8, 0)).norm(), 1e-15);
  EXPECT_LE((d.witness_a - Vec3(0.5, 0.5, d.witness_a.z())).norm(), 1e-15);
  EXPECT_LE((d.witness_b - Vec3(3.5, 4.5, d.witness_a.z())).norm(), 1e-15);
}

TEST(AnalyticDepth, SmallBoxInsideALargeOneLeavesThroughTheNearestWall) {
  const PenetrationDepth d = solve(box(0.25, 0.25, 0.25), at(0, 0.5, 1), box(8, 4, 2), at(0, 0, 0));
  EXPECT_EQ(d.contact, ContactClass::overlapping);
  EXPECT_EQ(d.depth, 1.25);
  EXPECT_EQ(d.translation, Vec3(0, 0, 1.25));
}

TEST(AnalyticDepth, EdgeAgainstEdge) {
  // Two square prisms standing on edges, their ridges crossed: P's nearest facet is the ridges' parallelogram.
  const Mat3 about_x = (Mat3() << 1, 0, 0, 0, 0.5, -0.5, 0, 0.5, 0.5).finished();  // 45 degrees, shrunk by sqrt(1/2)
  Mat3 about_y = Mat3::Zero();
  about_y << 0.5, 0, 0.5, 0, 1, 0, -0.5, 0, 0.5;
  const ConvexShape long_x = box(4, 1, 1);
  const ConvexShape long_y = box(1, 4, 1);
  const Pose below = Pose::from_trusted_matrix(about_x, Vec3::Zero());
  const Pose above = Pose::from_trusted_matrix(about_y, Vec3(0, 0, 1.875));
  const PenetrationDepth d = solve(long_x, below, long_y, above);
  EXPECT_EQ(d.contact, ContactClass::overlapping);
  EXPECT_EQ(d.depth, 0.125);
  EXPECT_EQ(d.translation, Vec3(0, 0, -0.125));
  EXPECT_EQ(d.feature_a.kind, Feature::Kind::edge);
  EXPECT_EQ(d.feature_b.kind, Feature::Kind::edge);
}

TEST(AnalyticDepth, SpheresAndCapsulesAreExact) {
  const ConvexShape sphere = *ConvexShape::sphere(1);
  const PenetrationDepth d = solve(sphere, at(0, 0, 0), sphere, at(0, 1.5, 0));
  EXPECT_EQ(d.contact, ContactClass::overlapping);
  EXPECT_NEAR(d.depth, 0.5, 1e-15);
  EXPECT_LE((d.normal - Vec3(0, -1, 0)).norm(), 1e-15);

  const PenetrationDepth kiss = solve(sphere, at(0, 0, 0), sphere, at(0, 2, 0));
  EXPECT_EQ(kiss.contact, ContactClass::touching);

  const ConvexShape capsule = *ConvexShape::capsule(0.5, 2, 2);
  const PenetrationDepth c = solve(capsule, at(0, 0, 0), sphere, at(1.25, 0, 1.75));
  EXPECT_EQ(c.contact, ContactClass::overlapping);
  EXPECT_NEAR(c.depth, 0.25, 1e-15);
  EXPECT_LE((c.normal - Vec3(-1, 0, 0)).norm(), 1e-15);

  const PenetrationDepth same = solve(sphere, at(0, 0, 0), sphere, at(0, 0, 0));
  EXPECT_EQ(same.contact, ContactClass::overlapping);
  EXPECT_NEAR(same.depth, 2, 1e-15);
  EXPECT_NEAR(same.normal.norm(), 1, 1e-15);
}

TEST(AnalyticDepth, FlatBodies) {
  const auto hull = [](std::vector<Vec3> points) { return ConvexShape(*ConvexPolytope::from_points(points)); };
  const ConvexShape square = hull({{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}});
  const ConvexShape segment = hull({{0, 0, -1}, {0, 0, 3}});
  const ConvexShape point = hull({{0, 0, 0}});
  const ConvexShape cube = box(2, 2, 2);

  // The pole pierces the square: the nearest way out is sideways, less than down by 1.
  const PenetrationDepth pierced = solve(square, at(0, 0, 0), segment, at(0.5, 0, 0));
  EXPECT_EQ(pierced.contact, ContactClass::overlapping);
  EXPECT_EQ(pierced.depth, 0.5);
  EXPECT_EQ(solve(square, at(0, 0, 0), segment, at(1, 0, 0)).contact, ContactClass::touching);
  EXPECT_EQ(solve(square, at(0, 0, 0), segment, at(1.25, 0, 0)).distance, 0.25);

  // Flat differences can only touch.
  EXPECT_EQ(solve(square, at(0, 0, 0), square, at(0.5, 0, 0)).contact, ContactClass::touching);
  EXPECT_EQ(solve(segment, at(0, 0, 0), segment, at(0, 0, 1)).contact, ContactClass::touching);
  EXPECT_EQ(solve(point, at(1, 2, 3), point, at(1, 2, 3)).contact, ContactClass::touching);
  EXPECT_EQ(solve(point, at(0, 0, 0), point, at(3, 4, 0)).distance, 5);

  const PenetrationDepth inside = solve(point, at(1, 0, 0), cube, at(0, 0, 0));
  EXPECT_EQ(inside.contact, ContactClass::overlapping);
  EXPECT_EQ(inside.depth, 1);
  EXPECT_EQ(inside.translation, Vec3(1, 0, 0));
}

TEST(AnalyticDepth, SmoothBodies) {
  const ConvexShape ellipsoid = *ConvexShape::ellipsoid(Vec3(1, 2, 3));
  const ConvexShape cylinder = *ConvexShape::cylinder(1, 2, 1);
  const ConvexShape cone = *ConvexShape::cone(1, 2, 2);
  const PenetrationDepth e = solve(ellipsoid, at(0, 0, 0), box(1, 1, 1), at(1.5, 0, 0));
  EXPECT_EQ(e.contact, ContactClass::overlapping);
  EXPECT_NEAR(e.depth, 0.5, 1e-6);
  EXPECT_LE(e.lower, 0.5);
  EXPECT_GE(e.upper, 0.5);
  const PenetrationDepth c = solve(cylinder, at(0, 0, 0), box(1, 1, 1), at(0, 2.5, 0));
  EXPECT_NEAR(c.depth, 0.5, 1e-6);
  EXPECT_LE((c.normal - Vec3(0, -1, 0)).norm(), 1e-2);
  const PenetrationDepth k = solve(cone, at(0, 0, 0), box(1, 1, 1), at(0, 0, 2.5));
  EXPECT_LE(k.lower, 0.5);
  EXPECT_GT(k.depth, 0.2);
  const PenetrationDepth apart = solve(cone, at(0, 0, 0), box(1, 1, 1), at(0, 0, 4));
  EXPECT_EQ(apart.contact, ContactClass::separated);
  EXPECT_NEAR(apart.distance, 1, 1e-6);
}

/// Both caps' planes are as far from the origin to within the bracket; the witnesses must belong to one of them.
TEST(AnalyticDepth, WitnessesWhereTwoOppositeFacetsAreTied) {
  const ConvexShape prism(*ConvexPolytope::from_points(scenes::prism(64)));
  const Pose turned =
      *Pose::from_quaternion({1.0, -3.314273968048357e-13, 2.30301967460123e-13, 2.9515569523755823e-13},
                             Vec3(-3.4840121796378397e-13, 9.283528021645887e-13, 1.2952863017305383e-13));
  Scratch scratch;
  const PenetrationDepth d =
      penetration_depth({&prism, Pose()}, {&prism, turned}, scratch, {.bracket = Bracket::certified});
  EXPECT_NEAR(d.depth, 1, 1e-11);
  EXPECT_NEAR(std::abs(d.witness_a.z()), 0.5, 1e-11);
  EXPECT_NEAR(std::abs(d.witness_b.z()), 0.5, 1e-11);
}

}  // namespace
}  // namespace pd
