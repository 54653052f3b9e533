// Impulses handed to the next step lead by half their trend: what a point begins with, and a tower that comes to rest.
#include "pair/impulse_trend.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "pd/bullet/solver_settings.hpp"
#include "scenes/bullet/bullet_scene.hpp"
#include "scenes/contact_worlds.hpp"

namespace pd::test {
namespace {

TEST(ImpulseTrend, LeadsByHalfOfTheWay) {
  detail::ImpulseTrend trend;
  EXPECT_EQ(trend.next(2, true), btScalar(2));  // nothing known before
  EXPECT_EQ(trend.next(3, true), btScalar(3.5));
  EXPECT_EQ(trend.next(1.5, true), btScalar(0.75));
  EXPECT_EQ(trend.next(3, false), btScalar(3));
  EXPECT_EQ(trend.next(4, true), btScalar(4.5));
}

TEST(ImpulseTrend, ABlowIsNoTrend) {
  detail::ImpulseTrend trend;
  trend.next(2, true);
  EXPECT_EQ(trend.next(60, true), btScalar(60));
  EXPECT_EQ(trend.next(2, true), btScalar(2));
  EXPECT_EQ(trend.next(3, true), btScalar(3.5));
  EXPECT_EQ(trend.next(0, true), btScalar(0));
  EXPECT_EQ(trend.next(1, true), btScalar(1));
}

TEST(ImpulseTrend, StaysWhereNobodySolved) {
  detail::ImpulseTrend trend;
  trend.next(2, true);
  const btScalar handed = trend.next(3, true);
  EXPECT_EQ(trend.next(handed, true), handed);
  EXPECT_EQ(trend.next(handed, true), handed);
  EXPECT_EQ(trend.next(4, true), btScalar(4.5));
}

/// The fastest body's speed after so long at the recommended settings and 60 Hz.
double speed_of_tower(scenes::ContactRun run, int seconds) {
  scenes::BulletScene scene(scenes::contact_scene("tower-1m").world, run);
  apply_recommended(scene.world().getSolverInfo());
  for (int i = 0; i < 60 * seconds; ++i) scene.step(60);
  double fastest = 0;
  for (int i = 0; i < scene.num_bodies(); ++i) {
    fastest = std::max(fastest, static_cast<double>(scene.body(i).getLinearVelocity().length()));
  }
  return fastest;
}

TEST(ImpulseTrend, TowerComesToRest) { EXPECT_LT(speed_of_tower(scenes::ContactRun::pdepth, 60), 0.05); }

}  // namespace
}  // namespace pd::test
