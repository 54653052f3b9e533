/// @file
/// Solids beside curved and swept shapes, against unions of boxes and against closed forms.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "pd/compound/compound_depth.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "pd/solid/solid_depth.hpp"
#include "solid_families.hpp"

namespace pd::test {
namespace {

Pose moved(const Vec3& translation) { return *Pose::from_matrix(Mat3::Identity(), translation); }

ConvexShape shape_number(std::mt19937_64& random, int kind) {
  std::uniform_real_distribution<double> size(0.15, 0.6);
  const double r = size(random), h = size(random);
  switch (kind % 6) {
    case 0:
      return *ConvexShape::sphere(r);
    case 1:
      return *ConvexShape::capsule(r, h, 2);
    case 2:
      return *ConvexShape::cylinder(r, h, 1);
    case 3:
      return *ConvexShape::cone(r, h, 2);
    case 4:
      return *ConvexShape::ellipsoid({r, h, 0.3});
    default:
      return *ConvexShape(*ConvexPolytope::box({r, h, 0.3})).with_margin(0.1);
  }
}

Pose random_pose(std::mt19937_64& random, const Vec3& translation) {
  std::normal_distribution<double> normal;
  const Eigen::Vector4d unit =
      Eigen::Vector4d(normal(random), normal(random), normal(random), normal(random)).normalized();
  return *Pose::from_quaternion({unit[0], unit[1], unit[2], unit[3]}, translation);
}

/// The solid is moved by what was told, and by a little less than the lower end in many directions.
void expect_bracket_holds(const MeshSolid& a, const PosedShape& b, const SolidDepth& found, Scratch& scratch) {
  EXPECT_LE(found.translation.norm(), found.upper * (1 + 1e-15));
  EXPECT_NE(*classify({&a, moved((1 + 1e-9) * found.translation)}, b, scratch), ContactClass::overlapping);
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 20; ++i) {
    const Vec3 unit = i == 0 ? Vec3(found.translation.normalized())
                             : Vec3{normal(random), normal(random), normal(random)}.normalized();
    EXPECT_EQ(*classify({&a, moved(0.9999 * found.lower * unit)}, b, scratch), ContactClass::overlapping) << i;
  }
}

struct Counts {
  int overlapping = 0;
  int separated = 0;
};

/// Solids of `fine` squares along each side of a cell, beside each kind of shape, and the same as boxes.
Counts compare_with_boxes(int pairs, int fine, double delta) {
  std::mt19937_64 random(41);
  std::uniform_real_distribution<double> place(-0.7, 1.7);
  Scratch scratch;
  Counts counts;
  for (int pair = 0; pair < pairs; ++pair) {
    SCOPED_TRACE(pair);
    const Cells cells = random_cells(random, 3 + pair % 3);
    const MeshSolid solid = fine_solid(cells, fine);
    const Compound boxes = boxes_of(cells);
    const ConvexShape shape = shape_number(random, pair);
    const Pose pose = random_pose(random, {place(random), place(random), place(random)});
    const Compound alone(shape);
    const UnionDepth known = *penetration_depth({&boxes, Pose()}, {&alone, pose}, scratch);
    const SolidDepth found =
        *penetration_depth(PosedSolid{&solid, Pose()}, PosedShape{&shape, pose}, scratch, {.delta = delta});
    EXPECT_EQ(found.contact, known.contact);
    EXPECT_EQ(*classify({&solid, Pose()}, {&shape, pose}, scratch), known.contact);
    if (found.contact == ContactClass::separated) {
      ++counts.separated;
      EXPECT_LE(found.distance_lower, known.distance_upper * (1 + 1e-12));
      EXPECT_GE(found.distance_upper, known.distance_lower * (1 - 1e-12));
      EXPECT_NEAR((found.witness_a - found.witness_b).norm(), found.distance_upper, 1e-9);
    }
    if (found.contact != ContactClass::overlapping) continue;
    ++counts.overlapping;
    EXPECT_TRUE(found.bracket_reached) << found.lower << " " << found.upper;
    EXPECT_LE(found.lower, known.upper * (1 + 1e-9));
    EXPECT_GE(found.upper, known.lower * (1 - 1e-9));
    expect_bracket_holds(solid, {&shape, pose}, found, scratch);
  }
  return counts;
}

TEST(SolidBeside, UnionsOfBoxesByParts) {
  const Counts counts = compare_with_boxes(60, 1, 0.01);
  EXPECT_GT(counts.overlapping, 20);
  EXPECT_GT(counts.separated, 15);
}

/// Above 2,000 triangles no parts are cut: the cover of translations answers.
TEST(SolidBeside, UnionsOfBoxesByTheCover) {
  const Counts counts = compare_with_boxes(12, 14, 0.05);
  EXPECT_GT(counts.overlapping, 3);
  EXPECT_GT(counts.separated, 3);
}

/// Seven cells around a hollow one.
MeshSolid hollow_cube() {
  Cells cells;
  for (int i = 0; i < 27; ++i) {
    if (i != 13) cells.insert({i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1});
  }
  return solid_of(mesh_of(cells));
}

TEST(SolidBeside, BallsInACavity) {
  const MeshSolid solid = hollow_cube();
  Scratch scratch;
  const Pose middle = moved({0.5, 0.5, 0.5});
  const ConvexShape small = *ConvexShape::sphere(0.375), tight = *ConvexShape::sphere(0.5);
  const SolidDepth apart = *penetration_depth(PosedSolid{&solid, Pose()}, PosedShape{&small, middle}, scratch);
  ASSERT_EQ(apart.contact, ContactClass::separated);
  EXPECT_NEAR(apart.distance_upper, 0.125, 1e-15);
  EXPECT_GE(apart.face_a, 0);
  EXPECT_EQ(apart.face_b, -1);
  EXPECT_EQ(*classify({&solid, Pose()}, {&tight, middle}, scratch), ContactClass::touching);
  // Within the wall no triangle meets the ball, whose way out leads through the wall that is one cell thick.
  const ConvexShape tiny = *ConvexShape::sphere(0.25);
  const Pose wall = moved({0.5, 0.5, 1.5});
  const SolidDepth inside = *penetration_depth(PosedSolid{&solid, Pose()}, PosedShape{&tiny, wall}, scratch);
  ASSERT_EQ(inside.contact, ContactClass::overlapping);
  EXPECT_LE(inside.lower, 0.75);
  EXPECT_GE(inside.upper, 0.75);
  EXPECT_TRUE(inside.bracket_reached);
  expect_bracket_holds(solid, {&tiny, wall}, inside, scratch);
}

TEST(SolidBeside, TheOrderOfTheBodies) {
  const MeshSolid solid = hollow_cube();
  const ConvexShape ball = *ConvexShape::sphere(0.25);
  Scratch scratch;
  for (const Vec3& at : {Vec3(0.6, 0.5, 0.5), Vec3(0.6, 0.7, 1.125), Vec3(2.5, 0.5, 0.5)}) {
    const Pose pose = moved(at);
    const SolidDepth one = *penetration_depth(PosedSolid{&solid, Pose()}, PosedShape{&ball, pose}, scratch);
    const SolidDepth other = *penetration_depth(PosedShape{&ball, pose}, PosedSolid{&solid, Pose()}, scratch);
    EXPECT_EQ(one.contact, other.contact);
    EXPECT_EQ(one.lower, other.lower);
    EXPECT_EQ(one.upper, other.upper);
    EXPECT_EQ(one.face_a, other.face_b);
    EXPECT_EQ(one.translation, Vec3(-other.translation));
    if (one.contact == ContactClass::separated) {
      EXPECT_EQ(one.witness_a, other.witness_b);
      EXPECT_EQ(one.distance_upper, other.distance_upper);
    }
  }
}

TEST(SolidBeside, APolytopeIsAskedAsASolid) {
  const MeshSolid solid = hollow_cube();
  const ConvexPolytope box = *ConvexPolytope::box({0.25, 0.25, 0.5});
  const ConvexShape shape = box;
  const MeshSolid as_solid = *MeshSolid::from_polytope(box);
  Scratch scratch;
  const Pose pose = moved({0.5, 0.75, 1.25});
  const SolidDepth one = *penetration_depth(PosedSolid{&solid, Pose()}, PosedShape{&shape, pose}, scratch);
  const SolidDepth other = *penetration_depth(PosedSolid{&solid, Pose()}, PosedSolid{&as_solid, pose}, scratch);
  ASSERT_EQ(one.contact, ContactClass::overlapping);
  EXPECT_EQ(one.lower, other.lower);
  EXPECT_EQ(one.upper, other.upper);
  EXPECT_EQ(one.translation, other.translation);
}

TEST(SolidBeside, SubnormalSolidsAreAnsweredAsLargeOnes) {
  Scratch scratch;
  for (const int exponent : {0, -1000, -1001, -1022, -1023, -1030, -1050}) {
    SCOPED_TRACE(exponent);
    const double s = std::ldexp(1.0, exponent);
    const ConvexPolytope cube = *ConvexPolytope::box({s, s, s});
    const MeshSolid solid = *MeshSolid::from_polytope(cube);
    const ConvexShape box(cube), ball = *ConvexShape::sphere(0.25 * s);
    const ConvexShape swept = *ConvexShape(*ConvexPolytope::box({0.25 * s, 0.25 * s, 0.25 * s})).with_margin(0.125 * s);
    for (const ConvexShape* shape : {&ball, &swept}) {
      const Pose pose = moved({0.25 * s, 0.125 * s, 0});
      const SolidDepth found = *penetration_depth(PosedSolid{&solid, Pose()}, PosedShape{shape, pose}, scratch);
      const PenetrationDepth known = penetration_depth({&box, Pose()}, {shape, pose}, scratch);
      EXPECT_EQ(*classify(PosedSolid{&solid, Pose()}, PosedShape{shape, pose}, scratch), ContactClass::overlapping);
      ASSERT_EQ(found.contact, ContactClass::overlapping);
      EXPECT_TRUE(found.bracket_reached);
      EXPECT_LE(found.lower, known.upper);
      EXPECT_GE(found.upper, known.lower);
      EXPECT_LE(found.upper, 1.0001 * known.upper);
    }
  }
}

TEST(SolidBeside, WhatIsRefused) {
  const MeshSolid solid = hollow_cube();
  const ConvexShape ball = *ConvexShape::sphere(1);
  const std::array<Vec3, 3> corners{Vec3::Zero(), 0.5 * Vec3::UnitX(), 0.5 * Vec3::UnitY()};
  const ConvexShape flat = *ConvexPolytope::from_points(corners);
  Scratch scratch;
  const PosedSolid posed{&solid, Pose()};
  const auto error_of = [&](const PosedShape& shape, const SolidSettings& settings) {
    return penetration_depth(posed, shape, scratch, settings).error();
  };
  EXPECT_EQ(error_of({&ball, Pose()}, {.delta = 0}).where, "delta");
  EXPECT_EQ(error_of({&ball, Pose()}, {.max_points = -1}).where, "max_points");
  EXPECT_EQ(error_of({&flat, Pose()}, {}).code, ErrorCode::not_full_dimensional);
  const PosedSolid far{&solid, moved({8e299, 0, 0})};
  const auto refused = penetration_depth(far, PosedShape{&ball, moved({-8e299, 0, 0})}, scratch);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::out_of_range);
  // A flat polytope with a margin has an interior.
  const ConvexShape swept = *flat.with_margin(0.1);
  EXPECT_EQ(*classify(posed, {&swept, moved({0.25, 0.25, 0.5})}, scratch), ContactClass::separated);
  EXPECT_EQ(*classify(posed, {&swept, moved({0.25, 0.25, 0.95})}, scratch), ContactClass::overlapping);
}

}  // namespace
}  // namespace pd::test
