// Queries that ask for distances of metres: each pair of children tells its closest point, and depths do not change.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "bullet_world.hpp"
#include "pd/bullet/install.hpp"

namespace pd::test {
namespace {

struct Asked : btCollisionWorld::ContactResultCallback {
  int points = 0;
  btScalar least = BT_LARGE_FLOAT;
  double sum = 0;
  btScalar addSingleResult(btManifoldPoint& point, const btCollisionObjectWrapper*, int, int,
                           const btCollisionObjectWrapper*, int, int) override {
    ++points;
    least = std::min(least, point.getDistance());
    sum += static_cast<double>(point.getDistance());
    return 0;
  }
};

/// Two bricks of two hulls each, in a compound of their own or in compounds inside of it.
struct Bricks : BulletWorld {
  explicit Bricks(const btVector3& at, bool nested = false) {
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
      const btTransform place(btQuaternion::getIdentity(), btVector3(x, 0, 0));
      if (nested) {
        auto* half = shape<btCompoundShape>();
        half->addChildShape(btTransform::getIdentity(), hull);
        brick->addChildShape(place, half);
      } else {
        brick->addChildShape(place, hull);
      }
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

/// Bullet tells one point for each pair of convex bodies.
TEST(FarQueries, TwoBoxesThatAreApartTellOnePoint) {
  BulletWorld world;
  BulletPenetrationDepthSolver solver;
  install(world.world(), solver);
  auto* const box = world.shape<btBoxShape>(btVector3(1, 1, 1));
  btRigidBody* const low = world.body(box, 1, btVector3(0, 0, 0));
  btRigidBody* const high = world.body(box, 1, btVector3(btScalar(0.5), 3, 0));
  Asked asked;
  asked.m_closestDistanceThreshold = 10;
  world.world().contactPairTest(low, high, asked);
  EXPECT_EQ(asked.points, 1);
  EXPECT_NEAR(asked.least, 1, 1e-5);
  Asked near;
  near.m_closestDistanceThreshold = btScalar(0.5);
  world.world().contactPairTest(low, high, near);
  EXPECT_EQ(near.points, 0);
}

TEST(FarQueries, CompoundsInCompoundsAnswerAsOne) {
  const btVector3 high(0, 3, 0), deep(btScalar(0.3), btScalar(0.9), btScalar(0.2));
  for (const btVector3& at : {high, deep}) {
    const Asked nested = Bricks(at, true).ask(10), flat = Bricks(at).ask(10);
    EXPECT_EQ(nested.points, flat.points);
    EXPECT_EQ(nested.least, flat.least);
    EXPECT_EQ(nested.sum, flat.sum);
  }
}

struct CountingDispatcher : btCollisionDispatcher {
  using btCollisionDispatcher::btCollisionDispatcher;
  btPersistentManifold* getNewManifold(const btCollisionObject* a, const btCollisionObject* b) override {
    ++manifolds;
    return btCollisionDispatcher::getNewManifold(a, b);
  }
  int manifolds = 0;
};

TEST(FarQueries, ManyChildrenShareOneManifold) {
  btDefaultCollisionConfiguration configuration;
  CountingDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  btCollisionWorld world(&dispatcher, &broadphase, &configuration);
  BulletPenetrationDepthSolver solver;
  install(world, solver);
  btBoxShape box(btVector3(1, 1, 1));
  btCompoundShape two, row;
  for (const int i : {0, 3}) {
    two.addChildShape(btTransform(btQuaternion::getIdentity(), btVector3(btScalar(i), 0, 0)), &box);
  }
  for (const int i : {0, 6}) {
    row.addChildShape(btTransform(btQuaternion::getIdentity(), btVector3(btScalar(i), 0, 0)), &two);
  }
  btCollisionObject first, second;
  first.setCollisionShape(&row);
  second.setCollisionShape(&row);
  second.setWorldTransform(btTransform(btQuaternion::getIdentity(), btVector3(0, 5, 0)));
  Asked asked;
  asked.m_closestDistanceThreshold = 100;
  world.contactPairTest(&first, &second, asked);
  EXPECT_EQ(asked.points, 16);
  EXPECT_NEAR(asked.least, 3, 1e-5);
  EXPECT_EQ(dispatcher.manifolds, 1);

  // The table of closest points is the host's again.
  uninstall(world, solver);
  dispatcher.manifolds = 0;
  world.contactPairTest(&first, &second, asked);
  EXPECT_EQ(dispatcher.manifolds, 16);
}

/// A compound with children of every kind: convex ones, one without an exact form, a compound, a mesh, and nothing.
/// Above it stand a hull and a compound.
struct ManyKinds : BulletWorld {
  explicit ManyKinds(bool ours) {
    if (ours) install(world(), solver);
    auto* const hull = box_hull(*this, btVector3(1, 1, 1), btScalar(0.01));
    auto* const balls = shape<btMultiSphereShape>(&centre, &radius, 1);
    balls->setLocalScaling(btVector3(1, 2, 1));
    auto* const inner = shape<btCompoundShape>();
    auto* const box = shape<btBoxShape>(btVector3(btScalar(0.2), btScalar(0.3), btScalar(0.4)));
    box->setMargin(btScalar(0.001));  // Bullet's box has rounded corners
    inner->addChildShape(at(0), box);
    inner->addChildShape(at(2), shape<btSphereShape>(btScalar(0.5)));
    mesh.addTriangle(btVector3(-1, 0, -1), btVector3(1, 0, -1), btVector3(0, 0, 1));
    mesh.addTriangle(btVector3(-1, 0, -1), btVector3(1, 0, -1), btVector3(0, 1, -2));
    auto* const low = shape<btCompoundShape>();
    low->addChildShape(at(0), hull);
    low->addChildShape(at(4), balls);
    low->addChildShape(at(8), inner);
    low->addChildShape(at(12), shape<btBvhTriangleMeshShape>(&mesh, true));
    low->addChildShape(at(16), shape<btEmptyShape>());
    auto* const high = shape<btCompoundShape>();
    high->addChildShape(at(0), hull);
    high->addChildShape(at(4), inner);
    body(low, 0, at(0));
    const btTransform above(btQuaternion(btVector3(1, 2, 3).normalized(), btScalar(0.3)), btVector3(1, 8, 2));
    for (btCollisionShape* const shape : {static_cast<btCollisionShape*>(hull), static_cast<btCollisionShape*>(high)}) {
      body(shape, 1, above);
    }
  }
  static btTransform at(int x) { return btTransform(btQuaternion::getIdentity(), btVector3(btScalar(x), 0, 0)); }
  Asked ask(std::size_t a, std::size_t b) {
    Asked asked;
    asked.m_closestDistanceThreshold = 100;
    world().contactPairTest(bodies()[a].get(), bodies()[b].get(), asked);
    return asked;
  }

  BulletPenetrationDepthSolver solver;
  btVector3 centre{0, 0, 0};
  btScalar radius = btScalar(0.4);
  btTriangleMesh mesh;
};

TEST(FarQueries, ChildrenOfEveryKindAreToldAsByBullet) {
  ManyKinds bullets(false), ours(true);
  for (const std::size_t above : {1U, 2U}) {
    for (const bool swapped : {false, true}) {
      const Asked expected = swapped ? bullets.ask(above, 0) : bullets.ask(0, above);
      const Asked told = swapped ? ours.ask(above, 0) : ours.ask(0, above);
      EXPECT_GT(told.points, 5);
      EXPECT_EQ(told.points, expected.points);
      EXPECT_NEAR(told.least, expected.least, 1e-3);
      EXPECT_NEAR(told.sum, expected.sum, 3e-3 * told.points);  // Bullet's GJK stops early
    }
  }
}

}  // namespace
}  // namespace pd::test
