// One line covers every pair of convex shapes, wherever Bullet makes it.
#include "pd/bullet/install.hpp"

#include <BulletCollision/CollisionShapes/btHeightfieldTerrainShape.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkEpaPenetrationDepthSolver.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "engine_glue/bullet_world.hpp"

double height_in_cpp14();  // client_in_cpp14.cc

namespace pd::test {
namespace {

class Install : public ::testing::TestWithParam<BulletContacts> {
 protected:
  BulletPenetrationDepthSolver solver;
  BulletWorld scene;
  btDiscreteDynamicsWorld& world = scene.world();

  /// Detects once and returns the deepest contact's depth.
  double detect() {
    world.performDiscreteCollisionDetection();
    return -scene.least_distance();
  }
};

TEST_P(Install, BoxBoxAndSphereAndCapsulePairs) {
  const auto box = [&] {
    auto* shape = scene.shape<btBoxShape>(btVector3(1, 1, 1));
    shape->setMargin(0);
    return shape;
  };
  struct Case {
    btCollisionShape* a;
    btCollisionShape* b;
    btScalar height;
    double depth;
  };
  const std::vector<Case> cases{
      {box(), box(), btScalar(1.75), 0.25},
      {scene.shape<btSphereShape>(btScalar(1)), scene.shape<btSphereShape>(btScalar(0.5)), btScalar(1.25), 0.25},
      {scene.shape<btCapsuleShape>(btScalar(0.5), btScalar(1)), scene.shape<btCapsuleShape>(btScalar(0.5), btScalar(1)),
       btScalar(1.75), 0.25},
      {scene.shape<btCapsuleShape>(btScalar(0.5), btScalar(1)), scene.shape<btSphereShape>(btScalar(1)), btScalar(1.75),
       0.25},
      {box(), scene.shape<btSphereShape>(btScalar(1)), btScalar(1.75), 0.25},
  };
  install(world, solver, GetParam());
  btScalar place = 0;
  for (const Case& c : cases) {
    scene.body(c.a, 0, btVector3(place, 0, 0));
    scene.body(c.b, 1, btVector3(place, c.height, 0));
    place += 20;
  }
  const double depth = detect();
  EXPECT_NEAR(depth, 0.25, 1e-5);
  ASSERT_EQ(scene.dispatcher().getNumManifolds(), static_cast<int>(cases.size()));
  for (int i = 0; i < scene.dispatcher().getNumManifolds(); ++i) {
    const btPersistentManifold* manifold = scene.dispatcher().getManifoldByIndexInternal(i);
    ASSERT_GT(manifold->getNumContacts(), 0);
    double deepest = 0;
    for (int k = 0; k < manifold->getNumContacts(); ++k) {
      const btManifoldPoint& point = manifold->getContactPoint(k);
      deepest = std::max(deepest, -static_cast<double>(point.getDistance()));
      // The normal points from body 1 to body 0.
      const btVector3 towards_0 =
          static_cast<const btCollisionObject*>(manifold->getBody0())->getWorldTransform().getOrigin() -
          static_cast<const btCollisionObject*>(manifold->getBody1())->getWorldTransform().getOrigin();
      EXPECT_GT(static_cast<double>(point.m_normalWorldOnB.dot(towards_0)), 0.9);
    }
    EXPECT_NEAR(deepest, 0.25, 1e-4) << i;
  }
}

TEST_P(Install, CompoundsMeshesAndHeightfields) {
  install(world, solver, GetParam());
  auto* child = scene.shape<btBoxShape>(btVector3(1, 1, 1));
  child->setMargin(0);
  auto* compound = scene.shape<btCompoundShape>();
  compound->addChildShape(btTransform(btQuaternion::getIdentity(), btVector3(0, 0, 0)), child);
  auto* other = scene.shape<btCompoundShape>();
  other->addChildShape(btTransform(btQuaternion::getIdentity(), btVector3(0, 0, 0)), child);
  scene.body(compound, 0, btVector3(0, 0, 0));
  scene.body(other, 1, btVector3(0, btScalar(1.75), 0));
  EXPECT_NEAR(detect(), 0.25, 1e-4);
  const auto after_compounds = solver.statistics().calls;
  EXPECT_GT(after_compounds, 0);

  btTriangleMesh mesh;
  mesh.addTriangle(btVector3(-5, 0, -5), btVector3(-5, 0, 5), btVector3(5, 0, 5));
  mesh.addTriangle(btVector3(-5, 0, -5), btVector3(5, 0, 5), btVector3(5, 0, -5));
  auto* floor = scene.shape<btBvhTriangleMeshShape>(&mesh, true);
  floor->setMargin(0);
  scene.body(floor, 0, btVector3(40, 0, 0));
  scene.body(scene.shape<btSphereShape>(btScalar(1)), 1, btVector3(41, btScalar(0.6), 0));
  EXPECT_NEAR(detect(), 0.4, 1e-4);
  const auto after_mesh = solver.statistics().calls;
  EXPECT_GT(after_mesh, after_compounds);

  std::vector<float> heights(25, 0.0f);
  const float* data = heights.data();
  auto* terrain = scene.shape<btHeightfieldTerrainShape>(5, 5, data, btScalar(-1), btScalar(1), 1, false);
  terrain->setMargin(0);
  scene.body(terrain, 0, btVector3(80, 0, 0));
  const auto before_terrain = solver.statistics().calls;
  scene.body(scene.shape<btSphereShape>(btScalar(1)), 1, btVector3(btScalar(80.3), btScalar(0.5), btScalar(0.2)));
  EXPECT_NEAR(detect(), 0.5, 1e-4);
  EXPECT_GT(solver.statistics().calls, before_terrain);
}

TEST_P(Install, ReachesPairsThatHaveAnAlgorithmAlready) {
  auto* box = scene.shape<btBoxShape>(btVector3(1, 1, 1));
  box->setMargin(0);
  scene.body(box, 0, btVector3(0, 0, 0));
  scene.body(box, 1, btVector3(0, btScalar(1.75), 0));
  detect();
  install(world, solver, GetParam());
  EXPECT_NEAR(detect(), 0.25, 1e-5);
  EXPECT_GT(solver.statistics().calls, 0);
}

TEST_P(Install, ContactPairTestAsksTheOtherTable) {
  install(world, solver, GetParam());
  auto* hull = box_hull(scene, btVector3(1, 1, 1), 0);
  btRigidBody* a = scene.body(hull, 0, btVector3(0, 0, 0));
  btRigidBody* b = scene.body(hull, 1, btVector3(0, btScalar(1.75), 0));
  struct Deepest : btCollisionWorld::ContactResultCallback {
    double distance = 1e30;
    btScalar addSingleResult(btManifoldPoint& point, const btCollisionObjectWrapper*, int, int,
                             const btCollisionObjectWrapper*, int, int) override {
      distance = std::min(distance, static_cast<double>(point.getDistance()));
      return 0;
    }
  } deepest;
  world.contactPairTest(a, b, deepest);
  EXPECT_NEAR(deepest.distance, -0.25, 1e-5);
  EXPECT_GT(solver.statistics().calls, 0);

  // Apart, within the callback's reach: the gap itself.
  b->setWorldTransform(btTransform(btQuaternion::getIdentity(), btVector3(0, btScalar(2.5), 0)));
  Deepest gap;
  gap.m_closestDistanceThreshold = 1;
  world.contactPairTest(a, b, gap);
  EXPECT_NEAR(gap.distance, 0.5, 1e-5);
}

INSTANTIATE_TEST_SUITE_P(BothWays, Install, ::testing::Values(BulletContacts::one_shot, BulletContacts::persistent));

TEST(InstallConfiguration, ExchangesTheSolverOfTheGeneralAlgorithm) {
  BulletPenetrationDepthSolver solver;
  BulletWorld scene;
  install(scene.configuration(), solver);
  auto* hull = box_hull(scene, btVector3(1, 1, 1), 0);
  scene.body(hull, 0, btVector3(0, 0, 0));
  scene.body(hull, 1, btVector3(0, btScalar(1.75), 0));
  scene.world().performDiscreteCollisionDetection();
  EXPECT_GT(solver.statistics().calls, 0);
  EXPECT_NEAR(-scene.least_distance(), 0.25, 1e-5);
}

TEST(OneShot, WholeManifoldFromTheFirstStepAndImpulsesCarriedOver) {
  BulletPenetrationDepthSolver solver;
  BulletWorld scene;
  install(scene.world(), solver);
  auto* box = scene.shape<btBoxShape>(btVector3(1, 1, 1));
  box->setMargin(0);
  scene.body(box, 0, btVector3(0, 0, 0));
  scene.body(box, 1, btVector3(0, 2, 0));
  scene.world().stepSimulation(btScalar(1.0 / 60), 0);
  EXPECT_EQ(scene.num_contacts(), 4);
  for (int i = 0; i < 30; ++i) {
    scene.world().stepSimulation(btScalar(1.0 / 60), 0);
  }
  ASSERT_EQ(scene.dispatcher().getNumManifolds(), 1);
  const btPersistentManifold* manifold = scene.dispatcher().getManifoldByIndexInternal(0);
  ASSERT_EQ(manifold->getNumContacts(), 4);
  double impulse = 0;
  for (int k = 0; k < 4; ++k) {
    EXPECT_GT(manifold->getContactPoint(k).getLifeTime(), 20);  // the same points all along
    impulse += static_cast<double>(manifold->getContactPoint(k).getAppliedImpulse());
  }
  EXPECT_NEAR(impulse, 9.81 / 60, 0.02);  // mass 1 at rest
}

TEST(OneShot, PairsKeepTheirMemory) {
  BulletPenetrationDepthSolver solver;
  BulletWorld scene;
  install(scene.world(), solver);
  // A prism over a hexagon: two boxes would be answered without a memory.
  auto* prism = scene.shape<btConvexHullShape>();
  for (int k = 0; k < 6; ++k) {
    const double angle = k * std::numbers::pi / 3;
    for (const double y : {-0.5, 0.5}) {
      prism->addPoint(btVector3(btScalar(std::cos(angle)), btScalar(y), btScalar(std::sin(angle))));
    }
  }
  prism->setMargin(0);
  auto* floor = scene.shape<btBoxShape>(btVector3(4, 1, 4));
  floor->setMargin(0);
  scene.body(floor, 0, btVector3(0, -1, 0));
  scene.body(prism, 1, btVector3(0, btScalar(0.499), 0));
  for (int i = 0; i < 30; ++i) scene.world().stepSimulation(btScalar(1.0 / 60), 0);
  EXPECT_GT(solver.statistics().warm, 15);
}

TEST(OneShot, TowerOfTenStands) {
  BulletPenetrationDepthSolver solver;
  BulletWorld scene;
  install(scene.world(), solver);
  scene.world().getSolverInfo().m_numIterations = 30;
  auto* box = scene.shape<btBoxShape>(btVector3(btScalar(0.5), btScalar(0.5), btScalar(0.5)));
  box->setMargin(0);
  auto* floor = scene.shape<btBoxShape>(btVector3(10, 1, 10));
  floor->setMargin(0);
  scene.body(floor, 0, btVector3(0, -1, 0));
  std::vector<btRigidBody*> tower;
  for (int i = 0; i < 10; ++i) {
    tower.push_back(scene.body(box, 1, btVector3(0, btScalar(0.5 + i), 0)));
  }
  scene.world().stepSimulation(btScalar(1.0 / 60), 0);
  EXPECT_EQ(scene.num_contacts(), 40);
  for (int i = 0; i < 300; ++i) {
    scene.world().stepSimulation(btScalar(1.0 / 60), 0);
  }
  for (int i = 0; i < 10; ++i) {
    const btVector3 drift = tower[i]->getWorldTransform().getOrigin() - btVector3(0, btScalar(0.5 + i), 0);
    EXPECT_LT(std::hypot(static_cast<double>(drift.x()), static_cast<double>(drift.z())), 0.25) << i;
    EXPECT_LT(std::abs(static_cast<double>(drift.y())), 0.1) << i;
  }
}

TEST(OneShot, ContactCallbacksSeeOneBeginningAndOneEnd) {
  static int started;
  static int ended;
  started = ended = 0;
  gContactStartedCallback = [](btPersistentManifold* const&) { ++started; };
  gContactEndedCallback = [](btPersistentManifold* const&) { ++ended; };
  BulletPenetrationDepthSolver solver;
  {
    BulletWorld scene;
    install(scene.world(), solver);
    auto* box = scene.shape<btBoxShape>(btVector3(1, 1, 1));
    box->setMargin(0);
    scene.body(box, 0, btVector3(0, 0, 0));
    btRigidBody* body = scene.body(box, 1, btVector3(0, 2, 0));
    for (int i = 0; i < 20; ++i) {
      scene.world().stepSimulation(btScalar(1.0 / 60), 0);
    }
    EXPECT_EQ(started, 1);
    EXPECT_EQ(ended, 0);
    body->setWorldTransform(btTransform(btQuaternion::getIdentity(), btVector3(0, btScalar(2.1), 0)));
    scene.world().stepSimulation(btScalar(1.0 / 60), 0);
    EXPECT_EQ(ended, 1);
  }
  gContactStartedCallback = nullptr;
  gContactEndedCallback = nullptr;
}

TEST(OneShot, StretchedMultispheresGoTheNamedWay) {
  btGjkEpaPenetrationDepthSolver epa;
  BulletSolverSettings settings;
  settings.fallback = &epa;
  BulletPenetrationDepthSolver solver(settings);
  BulletWorld scene;
  install(scene.world(), solver);
  const btVector3 centres[2] = {btVector3(0, 0, 0), btVector3(1, 0, 0)};
  const btScalar radii[2] = {1, btScalar(0.5)};
  auto* spheres = scene.shape<btMultiSphereShape>(centres, radii, 2);
  spheres->setLocalScaling(btVector3(1, 1, btScalar(1.5)));
  scene.body(spheres, 0, btVector3(0, 0, 0));
  scene.body(scene.shape<btSphereShape>(btScalar(1)), 1, btVector3(0, btScalar(1.8), 0));
  scene.world().performDiscreteCollisionDetection();
  EXPECT_GT(solver.statistics().unsupported, 0);
  EXPECT_NEAR(-scene.least_distance(), 0.2, 1e-2);
}

TEST(Install, ServesClientsThatAreCompiledAsCpp14) { EXPECT_NEAR(height_in_cpp14(), 2, 1e-3); }

}  // namespace
}  // namespace pd::test
