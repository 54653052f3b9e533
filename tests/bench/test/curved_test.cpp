/// @file
/// Curved bodies: they stand as deep as was asked for, and the judge knows right from wrong.

#include "bench/pairs/curved.hpp"

#include <gtest/gtest.h>

#include "bench/pairs/judge.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"

namespace pd::bench {
namespace {

TEST(Curved, NamesAreChecked) {
  EXPECT_FALSE(choose_curved({"teapots"}));
  EXPECT_EQ(choose_curved({"cone/hull", "ball/cone"})->size(), 3u);
}

TEST(Curved, TheJudgeKnowsRightFromWrong) {
  const auto cells = choose_curved({});
  for (const CurvedCell& cell : *cells) {
    scenes::Random random(7);
    const Bodies bodies = curved_bodies(cell.pair, random);
    const CurvedJudge judge(bodies);
    for (const Standing& at : frames_inside(bodies, cell.depth, 2, random)) {
      const double truth = judge.depth(at);
      EXPECT_GT(truth, 0);
      if (cell.depth > 0) {
        EXPECT_NEAR(truth, cell.depth, 1e-5) << to_string(cell.pair);
      }
      Scratch scratch;
      const PenetrationDepth ours = penetration_depth({&bodies.a, at.a}, {&bodies.b, at.b}, scratch);
      const Vec3 way = ours.translation;
      EXPECT_LT(judge.error({true, ours.depth, way}, at, truth), 2e-6) << to_string(cell.pair);
      EXPECT_NEAR(judge.error({true, 1.01 * ours.depth, 1.01 * way}, at, truth), 0.01, 1e-5);
      EXPECT_NEAR(judge.error({true, ours.depth, 0.99 * way}, at, truth), 0.01, 1e-5);
      EXPECT_EQ(judge.error({false, 0, Vec3::Zero()}, at, truth), 1);
      // A body in the middle of another one leaves either way.
      if (cell.depth > 0) {
        EXPECT_GT(judge.error({true, ours.depth, -way}, at, truth), kTolerance);
      }
    }
  }
}

}  // namespace
}  // namespace pd::bench
