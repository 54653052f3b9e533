// Ten boxes that fall in a column and land as one: how often the column stands.
#include <btBulletDynamicsCommon.h>
#include <gtest/gtest.h>

#include <array>
#include <random>

#include "engine_glue/bullet_world.hpp"
#include "pd/bullet/install.hpp"
#include "pd/bullet/solver_settings.hpp"

namespace pd::test {
namespace {

/// Boxes of two metres that fall 19 m, from places that differ by 1e-4 m.
bool stands(unsigned start, bool recommended) {
  BulletPenetrationDepthSolver solver;
  BulletWorld world;
  install(world.world(), solver);
  world.world().setGravity(btVector3(0, -10, 0));
  if (recommended) apply_recommended(world.world().getSolverInfo());
  world.body(world.shape<btBoxShape>(btVector3(50, 50, 50)), 0, btVector3(0, -50, 0));
  auto* cube = world.shape<btBoxShape>(btVector3(1, 1, 1));
  std::mt19937 random(start);
  std::uniform_real_distribution<double> aside(-1e-4, 1e-4);
  std::array<btRigidBody*, 10> column{};
  for (std::size_t i = 0; i < column.size(); ++i) {
    const btVector3 place{btScalar(aside(random)), btScalar(20 + 2 * static_cast<double>(i)), btScalar(aside(random))};
    column[i] = world.body(cube, 1, place);
    column[i]->setActivationState(DISABLE_DEACTIVATION);
  }
  for (int step = 0; step < 900; ++step) world.world().stepSimulation(btScalar(1) / 60, 0);
  return column.back()->getWorldTransform().getOrigin().y() > 18;
}

int standing_of_20(bool recommended) {
  int count = 0;
  for (unsigned start = 0; start < 20; ++start) count += stands(start, recommended) ? 1 : 0;
  return count;
}

/// Of twenty, Bullet's own contacts let six stand at default settings and nine at recommended ones.
TEST(DroppedColumn, StandsAsOftenAsOnBulletsContacts) {
  EXPECT_GE(standing_of_20(false), 6);
  EXPECT_GE(standing_of_20(true), 9);
}

}  // namespace
}  // namespace pd::test
