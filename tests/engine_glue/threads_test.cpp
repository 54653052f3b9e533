// Worlds in parallel on one solver, and Bullet's dispatcher for many threads.
//
// Debian's Bullet is built without BT_THREADSAFE: its btParallelFor runs its loop on the calling thread, its spin
// mutexes do nothing and every thread has index 0, so that one world cannot be dispatched by several threads there.
// What can be shown is that `install` takes a btCollisionDispatcherMt and that its points are those of the plain
// dispatcher; the rest stands in one_world_threads_test.cpp.
#include <BulletCollision/CollisionDispatch/btCollisionDispatcherMt.h>
#include <gtest/gtest.h>

#include <thread>

#include "engine_glue/bullet_world.hpp"
#include "pd/bullet/install.hpp"
#include "pd/bullet/penetration_depth_solver.hpp"

namespace pd::test {
namespace {

/// A floor, bricks, a ball, a capsule, a cylinder and a hull that fall into a heap; which and where depends on `seed`.
void fill_world(BulletWorld& world, int seed) {
  world.body(world.shape<btBoxShape>(btVector3(10, 1, 10)), 0, btVector3(0, -1, 0));
  for (int i = 0; i < 14; ++i) {
    btCollisionShape* shape = nullptr;
    switch ((i + seed) % 5) {
      case 0:
        shape = world.shape<btBoxShape>(btVector3(btScalar(0.5), btScalar(0.25), btScalar(0.4)));
        break;
      case 1:
        shape = world.shape<btSphereShape>(btScalar(0.3));
        break;
      case 2:
        shape = world.shape<btCapsuleShape>(btScalar(0.2), btScalar(0.5));
        break;
      case 3:
        shape = world.shape<btCylinderShape>(btVector3(btScalar(0.3), btScalar(0.4), btScalar(0.3)));
        break;
      default:
        shape = box_hull(world, btVector3(btScalar(0.3), btScalar(0.3), btScalar(0.3)), btScalar(0.04));
    }
    const btScalar aside = btScalar(0.11) * btScalar((i * 7 + seed * 3) % 5 - 2);
    world.body(shape, 1, btVector3(aside, btScalar(0.6) + btScalar(0.7) * btScalar(i), -aside));
  }
}

std::vector<btScalar> numbers_after(BulletWorld& world, int steps) {
  for (int i = 0; i < steps; ++i) world.world().stepSimulation(btScalar(1) / 60, 0);
  std::vector<btScalar> numbers;
  for (const auto& body : world.bodies()) {
    btScalar matrix[16];
    body->getWorldTransform().getOpenGLMatrix(matrix);
    numbers.insert(numbers.end(), matrix, matrix + 16);
  }
  return numbers;
}

constexpr int kSteps = 240;
constexpr int kWorlds = 4;

TEST(Threads, WorldsInParallelAreThoseAlone) {
  std::vector<std::vector<btScalar>> alone, together(kWorlds);
  for (int k = 0; k < kWorlds; ++k) {
    BulletPenetrationDepthSolver solver;
    BulletWorld world;
    fill_world(world, k);
    ASSERT_TRUE(install(world.world(), solver));
    alone.push_back(numbers_after(world, kSteps));
  }
  BulletPenetrationDepthSolver solver;
  std::vector<std::unique_ptr<BulletWorld>> worlds;
  for (int k = 0; k < kWorlds; ++k) {
    worlds.push_back(std::make_unique<BulletWorld>());
    fill_world(*worlds.back(), k);
    ASSERT_TRUE(install(worlds.back()->world(), solver));
  }
  std::vector<std::thread> threads;
  for (int k = 0; k < kWorlds; ++k) {
    threads.emplace_back([&, k] { together[k] = numbers_after(*worlds[k], kSteps); });
  }
  for (std::thread& thread : threads) thread.join();
  for (int k = 0; k < kWorlds; ++k) EXPECT_EQ(together[k], alone[k]) << "world " << k;
  EXPECT_NE(alone[0], alone[1]);
  EXPECT_GT(solver.statistics().calls, 1000);
  EXPECT_EQ(solver.statistics().exact_signs, 0);
}

/// Every contact point of a world in the order of its manifolds.
std::vector<btScalar> contact_numbers(btDispatcher& dispatcher) {
  std::vector<btScalar> numbers;
  for (int i = 0; i < dispatcher.getNumManifolds(); ++i) {
    const btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal(i);
    for (int k = 0; k < manifold.getNumContacts(); ++k) {
      const btManifoldPoint& point = manifold.getContactPoint(k);
      for (int c = 0; c < 3; ++c) {
        numbers.push_back(point.m_positionWorldOnB[c]);
        numbers.push_back(point.m_normalWorldOnB[c]);
      }
      numbers.push_back(point.getDistance());
    }
  }
  return numbers;
}

TEST(Threads, DispatcherForManyThreads) {
  btITaskScheduler* const before = btGetTaskScheduler();
  btSetTaskScheduler(btGetSequentialTaskScheduler());
  BulletPenetrationDepthSolver solver;
  BulletWorld plain;
  fill_world(plain, 2);
  ASSERT_TRUE(install(plain.world(), solver));
  (void)numbers_after(plain, kSteps);

  // The same bodies at the same poses, found afresh by either dispatcher.
  const auto points_of = [&](btCollisionDispatcher& dispatcher) {
    btDbvtBroadphase broadphase;
    btCollisionWorld world(&dispatcher, &broadphase, &plain.configuration());
    EXPECT_TRUE(install(world, solver));
    std::vector<btCollisionObject> objects(plain.bodies().size());
    for (std::size_t i = 0; i < objects.size(); ++i) {
      objects[i].setCollisionShape(plain.bodies()[i]->getCollisionShape());
      objects[i].setWorldTransform(plain.bodies()[i]->getWorldTransform());
      if (plain.bodies()[i]->isStaticObject())
        objects[i].setCollisionFlags(btCollisionObject::CF_STATIC_OBJECT);
      else
        objects[i].setCollisionFlags(0);
      world.addCollisionObject(&objects[i]);
    }
    world.performDiscreteCollisionDetection();
    const std::vector<btScalar> numbers = contact_numbers(dispatcher);
    for (btCollisionObject& object : objects) world.removeCollisionObject(&object);
    return numbers;
  };
  btCollisionDispatcher one(&plain.configuration());
  btCollisionDispatcherMt many(&plain.configuration());
  const std::vector<btScalar> expected = points_of(one);
  EXPECT_GT(expected.size(), 100u);
  EXPECT_EQ(points_of(many), expected);
  btSetTaskScheduler(before);
}

}  // namespace
}  // namespace pd::test
