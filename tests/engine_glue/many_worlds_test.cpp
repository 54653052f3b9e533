// One solver serves any number of worlds one after another, although Bullet tells nobody that a world has ended.
#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>
#include <btBulletDynamicsCommon.h>
#include <gtest/gtest.h>
#include <malloc.h>

#include <memory>
#include <vector>

#include "engine_glue/bullet_world.hpp"
#include "pd/bullet/install.hpp"
#include "pd/bullet/shape_cache.hpp"

namespace pd::test {
namespace {

/// A box on a floor, with pools for a few pairs only.
struct SmallWorld {
  static btDefaultCollisionConstructionInfo few_pairs() {
    btDefaultCollisionConstructionInfo info;
    info.m_defaultMaxPersistentManifoldPoolSize = 8;
    info.m_defaultMaxCollisionAlgorithmPoolSize = 8;
    return info;
  }
  SmallWorld() : configuration(few_pairs()), dispatcher(&configuration) {
    const btTransform above(btQuaternion::getIdentity(), btVector3(0, 2, 0));
    body.setWorldTransform(above);
    world.addRigidBody(&ground);
    world.addRigidBody(&body);
  }
  ~SmallWorld() {
    world.removeRigidBody(&body);
    world.removeRigidBody(&ground);
  }
  SmallWorld(const SmallWorld&) = delete;
  SmallWorld& operator=(const SmallWorld&) = delete;

  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher;
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver impulses;
  btDiscreteDynamicsWorld world{&dispatcher, &broadphase, &impulses, &configuration};
  btBoxShape box{btVector3(1, 1, 1)};
  btRigidBody ground{0, nullptr, &box};
  btRigidBody body{1, nullptr, &box, btVector3(1, 1, 1)};
};

std::size_t bytes_in_use() { return ::mallinfo2().uordblks; }

/// Worlds that live at the same time, so that each has an address of its own, and end without `uninstall`. What lies
/// between them sets them apart from those of another round.
void serve(BulletPenetrationDepthSolver& solver, int count, std::size_t between) {
  std::vector<std::unique_ptr<SmallWorld>> worlds;
  std::vector<std::unique_ptr<char[]>> spacers;
  for (int i = 0; i < count; ++i) {
    spacers.push_back(std::make_unique<char[]>(between));
    worlds.push_back(std::make_unique<SmallWorld>());
    ASSERT_TRUE(install(worlds.back()->world, solver));
    worlds.back()->world.stepSimulation(btScalar(1) / 60, 0);
    EXPECT_EQ(worlds.back()->dispatcher.getManifoldByIndexInternal(0)->getNumContacts(), 4);
  }
}

TEST(ManyWorlds, TakeNoMemoryBeyondTheirEnd) {
  BulletSolverSettings settings;
  settings.cache_capacity = 16;
  BulletPenetrationDepthSolver solver(settings);
  serve(solver, 1000, 16);
  const std::size_t before = bytes_in_use();
  serve(solver, 1000, 1600);
  EXPECT_LT(bytes_in_use(), before + 50000);
}

TEST(ManyWorlds, UninstallSaysWhetherTheSolverWasThere) {
  BulletPenetrationDepthSolver solver, other;
  SmallWorld one, two;
  EXPECT_FALSE(uninstall(one.world, solver));
  ASSERT_TRUE(install(one.world, solver));
  EXPECT_FALSE(uninstall(two.world, solver));
  EXPECT_FALSE(uninstall(one.world, other));
  EXPECT_TRUE(uninstall(one.world, solver));
  EXPECT_FALSE(uninstall(one.world, solver));
  // A dispatcher that was taken before it had a world.
  install(two.dispatcher, solver);
  two.world.stepSimulation(btScalar(1) / 60, 0);
  EXPECT_GT(solver.statistics().calls, 0);
  EXPECT_TRUE(uninstall(two.world, solver));
  EXPECT_FALSE(uninstall(two.world, solver));
}

/// Nothing is converted in the steps that follow.
TEST(Prepare, ConvertsTheShapesOfAWorldAheadOfItsSteps) {
  BulletPenetrationDepthSolver solver;
  BulletWorld scene;
  auto* compound = scene.shape<btCompoundShape>();
  auto* hull = box_hull(scene, btVector3(1, 1, 1), btScalar(0.01));
  compound->addChildShape(btTransform(btQuaternion::getIdentity(), btVector3(1, 0, 0)), hull);
  compound->addChildShape(btTransform(btQuaternion::getIdentity(), btVector3(-1, 0, 0)),
                          scene.shape<btSphereShape>(btScalar(1)));
  const btVector3 centres[2] = {btVector3(0, 0, 0), btVector3(1, 0, 0)};
  const btScalar radii[2] = {1, 1};
  auto* stretched = scene.shape<btMultiSphereShape>(centres, radii, 2);
  stretched->setLocalScaling(btVector3(1, 2, 1));
  scene.body(scene.shape<btBoxShape>(btVector3(20, 1, 20)), 0, btVector3(0, -1, 0));
  for (int i = 0; i < 3; ++i) scene.body(compound, 1, btVector3(0, btScalar(1 + 2 * i), 0));
  scene.body(stretched, 1, btVector3(10, 1, 0));
  const PreparedShapes prepared = prepare(scene.world(), solver);
  EXPECT_EQ(prepared.shapes, 4);
  EXPECT_EQ(prepared.without_form, 1);
  install(scene.world(), solver);
  const std::int64_t conversions = solver.cache().conversions();
  for (int i = 0; i < 30; ++i) scene.world().stepSimulation(btScalar(1) / 60, 0);
  EXPECT_GT(solver.statistics().calls, 30);
  EXPECT_EQ(solver.cache().conversions(), conversions);
}

/// Shows how much memory Bullet's solver has for the rows of multibodies.
struct SolverWithRows : btMultiBodyConstraintSolver {
  [[nodiscard]] int room() const { return m_data.m_jacobians.capacity(); }
};

// Otherwise Bullet's arrays grow row by row, and are copied each time.
TEST(Prepare, ReservesTheRowsOfMultibodies) {
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  SolverWithRows rows;
  btMultiBodyDynamicsWorld world(&dispatcher, &broadphase, &rows, &configuration);
  world.setGravity(btVector3(0, btScalar(-9.81), 0));
  btBoxShape ground(btVector3(20, 1, 20));
  btRigidBody floor(0, nullptr, &ground);
  floor.setWorldTransform(btTransform(btQuaternion::getIdentity(), btVector3(0, -1, 0)));
  world.addRigidBody(&floor, 1, 3);
  btBoxShape brick(btVector3(btScalar(0.4), btScalar(0.2), btScalar(0.2)));
  btVector3 inertia;
  brick.calculateLocalInertia(1, inertia);
  std::vector<std::unique_ptr<btMultiBody>> bodies;
  std::vector<std::unique_ptr<btMultiBodyLinkCollider>> colliders;
  for (int i = 0; i < 12; ++i) {
    bodies.push_back(std::make_unique<btMultiBody>(0, btScalar(1), inertia, false, false));
    btMultiBody& body = *bodies.back();
    body.finalizeMultiDof();
    const auto along = static_cast<btScalar>(0.8 * (i % 4) + 0.4 * (i / 4 % 2));
    body.setBaseWorldTransform(
        btTransform(btQuaternion::getIdentity(), btVector3(along, static_cast<btScalar>(0.2 + 0.4 * (i / 4)), 0)));
    world.addMultiBody(&body);
    colliders.push_back(std::make_unique<btMultiBodyLinkCollider>(&body, -1));
    colliders.back()->setCollisionShape(&brick);
    colliders.back()->setWorldTransform(body.getBaseWorldTransform());
    world.addCollisionObject(colliders.back().get(), 2, 3);
    body.setBaseCollider(colliders.back().get());
  }
  BulletPenetrationDepthSolver solver;
  ASSERT_TRUE(install(world, solver));
  (void)prepare(world, solver);
  const int room = rows.room();
  EXPECT_GT(room, 0);
  for (int i = 0; i < 3; ++i) world.stepSimulation(btScalar(1) / 60, 0);
  EXPECT_GT(dispatcher.getNumManifolds(), 12);
  EXPECT_EQ(rows.room(), room);
  for (const auto& collider : colliders) world.removeCollisionObject(collider.get());
  for (const auto& body : bodies) world.removeMultiBody(body.get());
  world.removeRigidBody(&floor);
}

}  // namespace
}  // namespace pd::test
