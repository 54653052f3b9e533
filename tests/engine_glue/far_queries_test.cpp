// Queries that ask for distances of metres: each pair of children tells its closest point, and depths do not change.
#include <gtest/gtest.h>

#include <algorithm>

#include "bullet_world.hpp"
#include "pd/bullet/install.hpp"

namespace pd::test {
namespace {

struct Asked : btCollisionWorld::ContactResultCallback {
  int points = 0;
  btScalar least = BT_LARGE_FLOAT;
  btScalar addSingleResult(btManifoldPoint& point, const btCollisionObjectWrapper*, int, int,
                           const btCollisionObjectWrapper*, int, int) override {
    ++points;
    least = std::min(least, point.getDistance());
    return 0;
  }
};

/// Two bricks of two hulls each.
struct Bricks : BulletWorld {
  explicit Bricks(const btVector3& at) {
    install(world(), solver);
    auto* hull = shape<btConvexHullShape>();
    for (const btScalar x : {btScalar(-0.5), btScalar(0.5)}) {
      for (const btScalar y : {btScalar(-0.5), btScalar(0.5)}) {
        for (const btScalar z : {btScalar(-0.5), btScalar(0.5)}) hull->addPoint(btVector3(x, y, z));
      }
    }
    hull->setMargin(0);
    auto* brick = shape<btCompoundShape>();
    for (const btScalar x : {btScalar(-0.5), btScalar(0.5)}) {
      brick->addChildShape(btTransform(btQuaternion::getIdentity(), btVector3(x, 0, 0)), hull);
    }
    first = body(brick, 1, btVector3(0, 0, 0));
    second = body(brick, 1, at);
  }
  Asked ask(btScalar within) {
    Asked asked;
    asked.m_closestDistanceThreshold = within;
    world().contactPairTest(first, second, asked);
    return asked;
  }
  BulletPenetrationDepthSolver solver;
  btRigidBody* first = nullptr;
  btRigidBody* second = nullptr;
};

TEST(FarQueries, ChildrenThatAreApartTellTheirClosestPoints) {
  Bricks bricks(btVector3(0, 3, 0));
  const Asked asked = bricks.ask(10);
  EXPECT_EQ(asked.points, 4);
  EXPECT_NEAR(asked.least, 2, 1e-5);
  EXPECT_EQ(bricks.ask(1).points, 0);
}

TEST(FarQueries, TheDepthDoesNotDependOnTheDistanceAskedFor) {
  Bricks bricks(btVector3(btScalar(0.3), btScalar(0.9), btScalar(0.2)));
  const Asked near = bricks.ask(btScalar(0.01)), far = bricks.ask(5);
  EXPECT_NEAR(near.least, -0.1, 1e-5);
  EXPECT_EQ(near.least, far.least);
}

}  // namespace
}  // namespace pd::test
