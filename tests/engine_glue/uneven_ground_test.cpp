// Bodies come to rest on ground of many small triangles that is nowhere flat.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine_glue/union_worlds.hpp"

namespace pd::test {
namespace {

btVector3 vector(double x, double y, double z) { return {btScalar(x), btScalar(y), btScalar(z)}; }

/// A bowl with waves, 6 m across.
btBvhTriangleMeshShape* waves(UnionWorld& world, double cell) {
  const int cells = static_cast<int>(6 / cell);
  const auto corner = [&](int i, int k) {
    const double x = cell * i - 3, z = cell * k - 3;
    return vector(x, .1 * (x * x + z * z) + .15 * std::sin(2 * x) * std::cos(2 * z), z);
  };
  std::vector<UnionWorld::Triangle> triangles;
  for (int i = 0; i < cells; ++i) {
    for (int k = 0; k < cells; ++k) {
      add_rectangle(triangles, corner(i, k), corner(i, k + 1), corner(i + 1, k + 1), corner(i + 1, k));
    }
  }
  return world.mesh(triangles, btScalar(CONVEX_DISTANCE_MARGIN));
}

/// The mean speed in the ninth second of a box that fell there turned and aside in the `start`th way.
double speed_after_a_fall(double cell, int start) {
  UnionWorld world;
  world.fixed(waves(world, cell))->setFriction(btScalar(.7));
  const btVector3 axis = vector(std::sin(1.7 * start), std::cos(2.3 * start), std::sin(.9 * start + 1)).normalized();
  const btTransform pose(btQuaternion(axis, btScalar(.8 * start)),
                         vector(1.4 * std::sin(5.1 * start), 1.2, 1.4 * std::cos(3.7 * start)));
  btRigidBody* body = world.moving(world.bullet.shape<btBoxShape>(vector(.25, .25, .25)), pose, vector(0, 0, 0));
  body->setFriction(btScalar(.7));
  body->setRollingFriction(btScalar(.02));
  body->setSpinningFriction(btScalar(.02));
  world.step(480);
  double sum = 0;
  for (int i = 0; i < 60; ++i) {
    world.step();
    sum += static_cast<double>(body->getLinearVelocity().length());
  }
  return sum / 60;
}

TEST(UnevenGround, BoxesComeToRest) {
  for (const double cell : {.1875, .5}) {
    std::vector<double> speeds;
    for (int start = 1; start <= 60; ++start) speeds.push_back(speed_after_a_fall(cell, start));
    std::sort(speeds.begin(), speeds.end());
    EXPECT_LT(speeds[44], 1e-3) << cell;  // three quarters
    EXPECT_LT(speeds[53], 3e-3) << cell;  // nine tenths
    EXPECT_LT(speeds[59], 0.02) << cell;
  }
}

}  // namespace
}  // namespace pd::test
