/// @file
/// Smooth bodies at the ends of what they can be: balls in all but name, whose directions are all tied; sizes far from
/// 1; brackets that rounding or a budget leaves too wide, and says so.

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "scenes/shape_families.hpp"

namespace pd {
namespace {

PenetrationDepth ask(const ConvexShape& a, const ConvexShape& b, const Pose& pose_b = Pose(),
                     const DepthSettings& settings = {}) {
  Scratch scratch;
  return penetration_depth({&a, Pose()}, {&b, pose_b}, scratch, settings);
}

ConvexShape ellipsoid(double x, double y, double z) { return *ConvexShape::ellipsoid({x, y, z}); }
ConvexShape point() {
  const Vec3 origin = Vec3::Zero();
  return *ConvexPolytope::from_points({&origin, 1});
}

void expect_depth(const PenetrationDepth& answer, double depth) {
  EXPECT_EQ(answer.contact, ContactClass::overlapping);
  EXPECT_TRUE(answer.bracket_reached);
  EXPECT_LE(answer.lower, depth * (1 + 1e-15));
  EXPECT_GE(answer.upper, depth * (1 - 1e-15));
  EXPECT_LE(answer.upper, answer.lower * (1 + 1.01e-6));
  EXPECT_LE((answer.witness_b - answer.witness_a - answer.translation).norm(), 1e-12 * depth);
  EXPECT_LE(answer.statistics.support_calls, 2000);
}

TEST(SmoothExtremes, BallsInAllButName) {
  expect_depth(ask(ellipsoid(1, 1, 1), point()), 1);
  expect_depth(ask(ellipsoid(1, 1, 1), ellipsoid(2, 2, 2)), 3);
  expect_depth(ask(ellipsoid(1, 1, 1), ellipsoid(1, 1, 1), *Pose::from_matrix(Mat3::Identity(), {0.3, 0.4, 0})), 1.5);
  expect_depth(ask(ellipsoid(1, 1, 1.000001), ellipsoid(1, 1, 1.000001)), 2);
  expect_depth(ask(*ConvexShape::cylinder(0.001, 1, 2), *ConvexShape::cylinder(0.001, 1, 2)), 0.002);
  expect_depth(ask(*ConvexShape::cylinder(0.001, 1, 2), *ConvexShape::cylinder(0.001, 1, 0)), 0.002);
}

/// Nearly all directions within the bracket, and no ball tells: the budget ends it, and the answer says so.
TEST(SmoothExtremes, ABudgetEndsWithTheBracketSoFar) {
  DepthSettings settings;
  settings.delta = 1e-9;
  const PenetrationDepth answer = ask(ellipsoid(1, 1.0001, 1.0002), ellipsoid(1.0003, 1, 1.0001),
                                      *Pose::from_quaternion({0.5, 0.5, 0.5, 0.5}, {0.001, 0.002, 0.003}), settings);
  EXPECT_EQ(answer.contact, ContactClass::overlapping);
  EXPECT_LE(answer.statistics.support_calls, 50000);
  EXPECT_EQ(answer.bracket_reached, answer.upper <= (1 + 1.0001e-9) * answer.lower);
  EXPECT_LE(answer.upper, 1.002 * answer.lower);
}

TEST(SmoothExtremes, ABracketTooWideIsSaid) {
  const PenetrationDepth answer = ask(ellipsoid(1e10, 1, 1), *ConvexPolytope::box({1, 1, 1}));
  EXPECT_EQ(answer.contact, ContactClass::overlapping);
  EXPECT_EQ(answer.bracket_reached, answer.upper <= (1 + 1.001e-6) * answer.lower);
  EXPECT_LE(answer.lower, 2);
  EXPECT_GE(answer.upper, 2);
}

/// Times 2^k, every number of an answer is times 2^k, bit for bit.
TEST(SmoothExtremes, PowersOfTwoChangeNoBit) {
  scenes::Random random(3);
  for (int i = 0; i < 12; ++i) {
    const Vec3 radii = random.point(0.3, 1);
    const double radius = random.uniform(0.2, 1), height = random.uniform(0.2, 1);
    const auto quaternion = random.quaternion();
    const Vec3 offset = random.vector(0.2, 2.5);
    PenetrationDepth base;
    for (const int k : {0, -890, -500, -101, -100, -99, 60, 100, 101, 400, 890}) {
      const double s = std::ldexp(1, k);
      const ConvexShape a = *ConvexShape::ellipsoid(s * radii);
      const ConvexShape b = i % 2 == 0 ? *ConvexShape::cone(s * radius, s * height, 1)
                                       : *ConvexShape::cylinder(s * radius, s * height, 2)->with_margin(0.125 * s);
      const PenetrationDepth answer = ask(a, b, *Pose::from_quaternion(quaternion, s * offset));
      if (k == 0) base = answer;
      SCOPED_TRACE(k);
      EXPECT_EQ(answer.contact, base.contact);
      EXPECT_EQ(answer.depth, s * base.depth);
      EXPECT_EQ(answer.lower, s * base.lower);
      EXPECT_EQ(answer.upper, s * base.upper);
      EXPECT_EQ(answer.distance_lower, s * base.distance_lower);
      EXPECT_EQ(answer.distance_upper, s * base.distance_upper);
      EXPECT_EQ(answer.normal, base.normal);
      EXPECT_EQ(answer.witness_a, Vec3(s * base.witness_a));
      EXPECT_EQ(answer.witness_b, Vec3(s * base.witness_b));
    }
  }
}

// Squares of such cores underflow beside such margins; lower ends were infinite.
TEST(SmoothExtremes, MarginsFarBeyondTheCoresHaveRightBrackets) {
  const Sphere spheres[] = {{{1, 0, 0}, 1}, {{0, 1, 0}, 0.5}};
  const Vec3 segment[] = {{1, 0, 0}, {0, 1, 0}};
  for (const double margin : {1e60, 1e90, 1e200, 1e250}) {
    const ConvexShape cone = *ConvexShape::cone(1, 1, 1), capsule(*ConvexPolytope::from_points(segment));
    for (const ConvexShape& core : {cone, *ConvexShape::hull_of_spheres(spheres)}) {
      const ConvexShape cloud = *core.with_margin(margin);
      for (const ConvexShape* const speck : {&cone, &capsule}) {
        for (const Bracket bracket : {Bracket::tightest, Bracket::certified, Bracket::contact}) {
          const PenetrationDepth answer = ask(*speck, cloud, Pose(), {.bracket = bracket});
          SCOPED_TRACE(margin);
          EXPECT_EQ(answer.contact, ContactClass::overlapping);
          EXPECT_LE(answer.lower, margin * (1 + 1e-15));
          EXPECT_GE(answer.lower, margin * (1 - 1e-12));
          EXPECT_GE(answer.upper, margin * (1 - 1e-15));
          EXPECT_LE(answer.upper, margin * (1 + 1e-12));
          EXPECT_TRUE(answer.bracket_reached);
          EXPECT_NEAR(answer.normal.norm(), 1, 1e-12);
        }
      }
    }
  }
}

// A translation less such margins is the rounding of both; it was taken for a place in the facet.
TEST(RoundedExtremes, WitnessesOfSpecksBesideHugeMarginsAreFinite) {
  const double size = 0x1p-781, margin = 0x1p546;
  std::vector<Vec3> cone{{-2, -1, -2}, {-1, 1, 0}, {0, 2, 0}, {1, -2, 0}, {2, -1, 0}};
  std::vector<Vec3> triangle{{-1, 2, -1}, {0, 2, 0}, {2, 1, 2}};
  for (std::vector<Vec3>* const points : {&cone, &triangle}) {
    for (Vec3& point : *points) point *= size;
  }
  const ConvexShape speck = *ConvexPolytope::from_points(cone);
  const ConvexShape cloud = *ConvexShape(*ConvexPolytope::from_points(triangle)).with_margin(margin);
  for (const Bracket bracket : {Bracket::tightest, Bracket::certified, Bracket::contact}) {
    const PenetrationDepth answer = ask(speck, cloud, Pose(), {.bracket = bracket});
    EXPECT_EQ(answer.contact, ContactClass::overlapping);
    EXPECT_NEAR(answer.depth / margin, 1, 1e-12);
    EXPECT_LE(answer.witness_a.cwiseAbs().maxCoeff(), 1e-15 * margin);
    EXPECT_NEAR((answer.witness_b / margin).norm(), 1, 1e-12);
  }
}

TEST(SmoothExtremes, SizesBeyondAreRefusedByName) {
  for (const double size : {1e-300, 1e280}) {
    for (const auto& shape : {ConvexShape::ellipsoid({size, size, size}), ConvexShape::cylinder(size, 1, 0),
                              ConvexShape::cone(1, size, 0)}) {
      ASSERT_FALSE(shape);
      EXPECT_EQ(shape.error().code, ErrorCode::out_of_range);
    }
  }
}

}  // namespace
}  // namespace pd
