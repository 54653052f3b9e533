/// @file
/// The memory of a pair of unions: warm answers are those of cold queries, over frames that hang together and over such
/// that do not, whatever is given to it.
#include "pd/compound/warm_union.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "compound/scene_compounds.hpp"
#include "pd/compound/compound_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "pd/shape/star_body.hpp"
#include "scenes/non_convex.hpp"

namespace pd {
namespace {

/// Bodies of every kind, and how far they stand apart at first.
struct Case {
  const char* name;
  Compound a, b;
  Vec3 offset;
};

std::vector<Case> cases(scenes::Random& random) {
  return {{"letters", compound_of(scenes::letter_l()), compound_of(scenes::letter_l()), {1.9, 0.9, 0.3}},
          {"cross in channel", compound_of(scenes::cross()), compound_of(scenes::letter_u(1)), {0.4, 0.2, 0.3}},
          {"stack and letter", compound_of(scenes::stack(4, 0.5)), compound_of(scenes::letter_l()), {0.2, 0.1, 0.15}},
          {"room", compound_of(scenes::room(1, 0.3)), compound_of(scenes::stack(2, 0.3)), {0.1, 0.2, 0.4}},
          {"rubble", compound_of(scenes::rubble(5, 10, random)), compound_of(scenes::rubble(4, 8, random)), {2, 1, 0}},
          {"balls",
           compound_of(scenes::rough_ball(0, 0.3, random)),
           compound_of(scenes::rough_ball(0, 0.3, random)),
           {0.5, 0.1, 0.2}}};
}

/// The frame after `pose`, turned and moved by up to `step`.
Pose moved(const Pose& pose, double step, scenes::Random& random) {
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(step, random.direction()));
  const Eigen::Quaterniond q = (turn * Eigen::Quaterniond(pose.rotation())).normalized();
  return *Pose::from_quaternion({q.w(), q.x(), q.y(), q.z()}, pose.translation() + step * random.direction());
}

void expect_same(const UnionDepth& warm, const UnionDepth& cold) {
  ASSERT_EQ(warm.contact, cold.contact);
  EXPECT_EQ(warm.lower, cold.lower);
  EXPECT_NEAR(warm.upper, cold.upper, 1e-15 * (1 + cold.upper));
  EXPECT_EQ(warm.depth, warm.upper);
  EXPECT_EQ(warm.distance, cold.distance);
  EXPECT_EQ(warm.distance_lower, cold.distance_lower);
  EXPECT_EQ(warm.distance_upper, cold.distance_upper);
  EXPECT_LE(warm.translation.norm(), warm.upper * (1 + 1e-15));
}

TEST(WarmUnion, CoherentFramesAreAnsweredAsColdOnes) {
  scenes::Random random(41);
  Scratch scratch;
  int warm_answers = 0, frames = 0;
  std::int64_t facets_cold = 0, facets_warm = 0;
  for (const Case& c : cases(random)) {
    for (const double step : {1e-3, 1e-2, 0.1}) {
      WarmUnion memory;
      Pose pose = random.pose(c.offset);
      for (int frame = 0; frame < 12; ++frame) {
        SCOPED_TRACE(testing::Message() << c.name << ", step " << step << ", frame " << frame);
        const PosedCompound a{&c.a, pose}, b{&c.b, Pose()};
        const auto cold = penetration_depth(a, b, scratch);
        const auto warm = penetration_depth(a, b, scratch, {}, &memory);
        expect_same(*warm, *cold);
        // The way out is free: a body moved by it does not overlap.
        if (warm->contact == ContactClass::overlapping) {
          EXPECT_NE(*point_in_difference(a, b, warm->translation, scratch), ContactClass::overlapping);
          facets_cold += cold->work.facets;
          facets_warm += warm->work.facets;
        }
        if (frame > 0) {
          ++frames;
          warm_answers += warm->warm ? 1 : 0;
        }
        pose = moved(pose, step, random);
      }
    }
  }
  EXPECT_GT(warm_answers, frames / 2);
  EXPECT_LT(facets_warm, facets_cold);
}

TEST(WarmUnion, BodiesNamedInEitherOrder) {
  scenes::Random random(42);
  Scratch scratch;
  // Two copies of one body: poses decide in which order a pair is solved.
  const Compound ball = compound_of(scenes::rough_ball(0, 0.3, random));
  for (const Case& c : {Case{"copies", ball, ball, {0.4, 0.1, 0.2}}, cases(random)[1]}) {
    WarmUnion memory;
    Pose pose_a = random.pose(c.offset), pose_b;
    for (int frame = 0; frame < 20; ++frame) {
      SCOPED_TRACE(testing::Message() << c.name << ", frame " << frame);
      PosedCompound a{&c.a, pose_a}, b{&c.b, pose_b};
      if (frame % 5 > 2) std::swap(a, b);
      expect_same(*penetration_depth(a, b, scratch, {}, &memory), *penetration_depth(a, b, scratch));
      pose_a = moved(pose_a, 0.01, random);
      pose_b = moved(pose_b, 0.01, random);
    }
  }
}

TEST(WarmUnion, JumpsAndOtherBodiesCostOnlyTime) {
  scenes::Random random(43);
  Scratch scratch;
  const std::vector<Case> all = cases(random);
  WarmUnion memory;
  for (int frame = 0; frame < 80; ++frame) {
    const Case& c = all[static_cast<std::size_t>(random.integer(0, static_cast<int>(all.size()) - 1))];
    const double far = random.uniform(0, 3);
    SCOPED_TRACE(testing::Message() << c.name << ", frame " << frame);
    const PosedCompound a{&c.a, random.pose(far * random.direction())};
    const PosedCompound b{&c.b, Pose()};
    expect_same(*penetration_depth(a, b, scratch, {}, &memory), *penetration_depth(a, b, scratch));
  }
}

TEST(WarmUnion, ARefusedOrCurvedQueryLeavesItOfUse) {
  scenes::Random random(44);
  Scratch scratch;
  const Compound ball = compound_of(scenes::rough_ball(0, 0.3, random));
  const Compound curved(*ConvexShape::cylinder(0.5, 1, 2));
  const PosedCompound a{&ball, random.pose({0.4, 0.1, 0.2})}, b{&ball, Pose()};
  WarmUnion memory;
  const UnionDepth cold = *penetration_depth(a, b, scratch, {}, &memory);
  UnionSettings few;
  few.max_facets = 100;
  EXPECT_EQ(penetration_depth(a, b, scratch, few, &memory).error().code, ErrorCode::limit_exceeded);
  const auto by_octree = penetration_depth(a, PosedCompound{&curved, Pose()}, scratch, {.delta = 0.5}, &memory);
  EXPECT_TRUE(by_octree.has_value());
  const UnionDepth warm = *penetration_depth(a, b, scratch, {}, &memory);
  EXPECT_TRUE(warm.warm);
  expect_same(warm, cold);
}

TEST(WarmUnion, CopiesAndForgets) {
  scenes::Random random(45);
  Scratch scratch;
  const Compound ball = compound_of(scenes::rough_ball(0, 0.3, random));
  const PosedCompound a{&ball, random.pose({0.4, 0.1, 0.2})}, b{&ball, Pose()};
  WarmUnion memory;
  EXPECT_EQ(memory.memory_bytes(), sizeof(memory));
  const UnionDepth cold = *penetration_depth(a, b, scratch, {}, &memory);
  EXPECT_GT(memory.memory_bytes(), 1000U);
  EXPECT_LT(memory.memory_bytes(), std::size_t{1} << 20);
  WarmUnion copy = memory;
  EXPECT_TRUE(penetration_depth(a, b, scratch, {}, &copy)->warm);
  copy.clear();
  EXPECT_FALSE(penetration_depth(a, b, scratch, {}, &copy)->warm);
  const WarmUnion taken = std::move(memory);
  EXPECT_GT(taken.memory_bytes(), 1000U);
  memory = copy;
  expect_same(*penetration_depth(a, b, scratch, {}, &memory), cold);
}

}  // namespace
}  // namespace pd
