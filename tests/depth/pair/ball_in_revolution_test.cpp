/// @file
/// Points and balls in cylinders and cones, on the axis and off it, in closed form: planes of a mantle are tied on the
/// axis, which cost an expansion thousands of supports.

#include <gtest/gtest.h>

#include <cmath>

#include "oracle/curved_oracle.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "scenes/shape_families.hpp"

namespace pd {
namespace {

using scenes::Random;

/// Of the body along a unit vector.
double reach(const PosedShape& body, const Vec3& unit) {
  const Vec3 origin = Vec3::Zero();
  const ConvexShape point = *ConvexPolytope::from_points({&origin, 1});
  return static_cast<double>(oracle::difference_support({&point, Pose()}, body, unit));
}

/// Every support bounds the depth from above, so none may lie below the lower bound; the answer's own proves the upper.
void expect_right(const PosedShape& a, const PosedShape& b, Random& random) {
  Scratch scratch;
  const PenetrationDepth d = penetration_depth(a, b, scratch, {.delta = 1e-6});
  ASSERT_EQ(d.contact, ContactClass::overlapping);
  EXPECT_TRUE(d.bracket_reached);
  EXPECT_LE(d.upper, d.lower * (1 + 1.01e-6));
  EXPECT_LE(d.statistics.support_calls, 4);
  const auto height = [&](const Vec3& unit) { return static_cast<double>(oracle::difference_support(a, b, unit)); };
  EXPECT_LE(height(d.normal), d.upper * (1 + 1e-15));
  EXPECT_GE(static_cast<double>(oracle::sweep_directions(a, b, 200, 3).least), d.lower);
  for (int k = 0; k < 60; ++k) {
    const Vec3 near = d.normal + std::pow(10.0, -(k % 6)) * random.direction();
    EXPECT_GE(height(near.normalized()), d.lower);
  }
  EXPECT_LE((d.witness_b - d.witness_a - d.translation).norm(), 1e-14);
  // A's witness is a point of A, B's one of B: no plane of theirs has it beyond.
  for (int k = 0; k < 60; ++k) {
    const Vec3 unit = random.direction();
    EXPECT_LE(d.witness_a.dot(unit), reach(a, unit) + 1e-14);
    EXPECT_LE(d.witness_b.dot(unit), reach(b, unit) + 1e-14);
  }
}

TEST(BallInRevolution, OnTheAxisAndOffIt) {
  Random random(3);
  for (int i = 0; i < 240; ++i) {
    SCOPED_TRACE(i);
    const double radius = random.uniform(0.3, 1), half = random.uniform(0.3, 1);
    const ConvexShape outer =
        i % 2 == 0 ? *ConvexShape::cone(radius, half, i % 3) : *ConvexShape::cylinder(radius, half, i % 3);
    const double r = random.uniform(0.02, 1.5);
    const ConvexShape ball = i % 5 < 3 ? *ConvexShape::sphere(r) : *ConvexShape::ellipsoid({r, r, r});
    // Where the body is at least a quarter as wide as at its widest.
    Vec3 inside = (i % 4 == 0 ? 0 : i % 4 == 1 ? 1e-9 : 0.24 * radius) * random.direction();
    inside[i % 3] = i % 8 == 0 ? 0 : random.uniform(-0.9, 0.4) * half;
    const Pose pose = random.pose({0.1, 0.2, 0.3});
    const PosedShape a{&outer, pose};
    const PosedShape b{&ball, random.pose(pose.apply(inside))};
    if (i % 7 < 3) {
      expect_right(a, b, random);
    } else {
      expect_right(b, a, random);
    }
  }
}

}  // namespace
}  // namespace pd
