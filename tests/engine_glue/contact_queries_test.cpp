// What worlds ask for is answered in doubles: no exact sign in any call, whatever touches what.
#include <gtest/gtest.h>

#include <algorithm>

#include "pd/bullet/penetration_depth_solver.hpp"
#include "scenes/bullet/bullet_scene.hpp"
#include "scenes/contact_worlds.hpp"

namespace pd::test {
namespace {

using scenes::BulletScene;
using scenes::ContactRun;

class Queries : public ::testing::TestWithParam<std::string> {};

TEST_P(Queries, NeedNoExactNumbers) {
  const scenes::ContactScene plan = scenes::contact_scene(GetParam());
  BulletScene scene(plan.world, ContactRun::pdepth);
  for (int step = 0; step < 40; ++step) {
    scene.step(60);
  }
  const BulletSolverStatistics statistics = scene.solver().statistics();
  EXPECT_GT(statistics.calls, 0);
  EXPECT_EQ(statistics.exact_signs, 0) << statistics.calls << " calls";
  EXPECT_LE(statistics.wider_brackets, 1e-3 * static_cast<double>(statistics.calls));
}

INSTANTIATE_TEST_SUITE_P(Scenes, Queries,
                         ::testing::Values("tower-1m", "cards", "slide-mesh", "slide-compound", "one-place", "slope"),
                         [](const auto& each) {
                           std::string name = each.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

}  // namespace
}  // namespace pd::test
