/// @file
/// Spheres and capsules whose cores are apart from a box, wherever they are nearest, against the exact oracle. Next to
/// a face, an edge or a corner there is a closed form.

#include <gtest/gtest.h>

#include "oracle/resting_pair.hpp"
#include "scenes/single_precision.hpp"

namespace pd {
namespace {

using oracle::JudgedPair;
using scenes::Random;

struct Counted {
  int at_once = 0;
  int on[4] = {};  ///< by Feature::Kind of the box
};

Counted ask(bool segment, bool single, bool swapped) {
  Counted counted;
  Scratch scratch;
  for (std::uint64_t seed = 1; seed <= 250; ++seed) {
    Random random(seed + (segment ? 1000 : 0));
    const double half = random.uniform(0.1, 1);
    scenes::Points core{{0, 0, -half}};
    if (segment) core.push_back({0, 0, half});
    const double x = random.uniform(0.2, 1), y = random.uniform(0.2, 1);
    const scenes::Points box = scenes::box({x, y, random.uniform(0.2, 1)});
    const Vec3 far = random.vector(0.4, 2);
    Pose core_pose = random.pose(far);
    Pose box_pose = random.pose(0.1 * random.direction());
    if (single) {
      core_pose = scenes::to_single(core_pose);
      box_pose = scenes::to_single(box_pose);
    }
    const JudgedPair pair(swapped ? scenes::PointPair{box, core, box_pose, core_pose}
                                  : scenes::PointPair{core, box, core_pose, box_pose});
    const double radius = random.uniform(0.1, 1);
    const double margin_a = swapped ? 0 : radius, margin_b = swapped ? radius : 0;
    const auto a = pair.a().shape->with_margin(margin_a);
    const auto b = pair.b().shape->with_margin(margin_b);
    const PenetrationDepth answer =
        penetration_depth({&*a, pair.a().pose}, {&*b, pair.b().pose}, scratch, {.bracket = Bracket::certified});
    EXPECT_EQ(oracle::check_rounded(pair, margin_a, margin_b, answer, Bracket::certified), "") << "seed " << seed;
    if (answer.statistics.support_calls != 1) continue;
    ++counted.at_once;
    ++counted.on[static_cast<int>((swapped ? answer.feature_a : answer.feature_b).kind)];
  }
  return counted;
}

TEST(SlenderNearBox, FacesEdgesAndCornersInClosedForm) {
  for (const bool segment : {false, true}) {
    for (const bool single : {false, true}) {
      for (const bool swapped : {false, true}) {
        const Counted counted = ask(segment, single, swapped);
        // The others cut the box.
        EXPECT_GT(counted.at_once, 150);
        for (const auto kind : {Feature::Kind::vertex, Feature::Kind::edge, Feature::Kind::facet}) {
          EXPECT_GT(counted.on[static_cast<int>(kind)], 10);
        }
        std::printf("%d at once: %d corners, %d edges, %d faces\n", counted.at_once, counted.on[1], counted.on[2],
                    counted.on[3]);
      }
    }
  }
}

}  // namespace
}  // namespace pd
