/// @file
/// Bodies apart: they stand at the gap that was asked for, and the judge knows right from wrong.

#include "bench/pairs/apart.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"

namespace pd::bench {
namespace {

using scenes::DepthClass;
using scenes::PairFamily;

TEST(Apart, NamesAreChecked) {
  EXPECT_FALSE(choose_apart({"teapots"}, {}, false));
  EXPECT_FALSE(choose_apart({"box"}, {32}, false));
  EXPECT_EQ(choose_apart({"sphere"}, {8, 32}, false)->size(), 6u);
}

TEST(Apart, TheJudgeKnowsRightFromWrong) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const PairFamily family : {PairFamily::sphere, PairFamily::prism}) {
    const Draw pair = *draw({family, 128, DepthClass::mid}, 5, 1);
    scenes::Random random(11);
    const ApartJudge judge(pair.bodies);
    for (const Standing& at : frames_apart(pair.bodies, 0.1, 2, random)) {
      Scratch scratch;
      const PenetrationDepth truth = penetration_depth({&pair.bodies.a, at.a}, {&pair.bodies.b, at.b}, scratch);
      EXPECT_NEAR(truth.distance, at.gap, 1e-9 * at.gap);
      const Vec3 way = truth.witness_b - truth.witness_a;
      const auto error = [&](const Answer& answer, double limit) {
        return judge.error(answer, at, limit, Precision::binary64);
      };
      EXPECT_LT(error({false, 0, way, truth.distance}, 0), 1e-9);
      EXPECT_LT(judge.error({false, 0, way, truth.distance}, at, 0, Precision::binary32), 1e-3);
      // A wrong direction proves nothing: the whole bodies decide.
      EXPECT_LT(error({false, 0, -way, truth.distance}, 0), 1e-9);
      EXPECT_NEAR(error({false, 0, way, 1.01 * truth.distance}, 0), 0.01, 1e-6);
      EXPECT_NEAR(error({false, 0, -way, 0.99 * truth.distance}, 0), 0.01, 1e-6);
      EXPECT_EQ(error({false, 0, way, kInfinity}, 0.5 * at.gap), 0);
      EXPECT_EQ(error({false, 0, way, kInfinity}, 1.5 * at.gap), 1);
      EXPECT_EQ(error({true, 0, Vec3::Zero(), 0}, 0), 1);
    }
  }
}

}  // namespace
}  // namespace pd::bench
