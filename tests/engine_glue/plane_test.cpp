// Convex bodies on a btStaticPlaneShape.
#include <BulletCollision/CollisionShapes/btStaticPlaneShape.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "engine_glue/bullet_world.hpp"
#include "pd/bullet/install.hpp"
#include "pd/bullet/snapshot.hpp"

namespace pd::test {
namespace {

const btVector3 kUp(0, 1, 0);

btVector3 vector(double x, double y, double z) { return {btScalar(x), btScalar(y), btScalar(z)}; }

struct PlaneWorld {
  explicit PlaneWorld(bool ours = true, const BulletSolverSettings& settings = {}) : solver(settings) {
    if (ours) install(world.world(), solver);
  }
  btRigidBody* plane(const btVector3& normal = kUp, double constant = 0) {
    btRigidBody* body = world.body(world.shape<btStaticPlaneShape>(normal, btScalar(constant)), 0, vector(0, 0, 0));
    body->setFriction(1);
    return body;
  }
  btRigidBody* moving(btCollisionShape* shape, const btTransform& pose) {
    btRigidBody* body = world.body(shape, 1, pose);
    body->setActivationState(DISABLE_DEACTIVATION);
    body->setFriction(1);
    return body;
  }
  void step(int count = 1) {
    for (int i = 0; i < count; ++i) world.world().stepSimulation(btScalar(1) / 60, 0);
  }
  [[nodiscard]] const btPersistentManifold& only_manifold() {
    EXPECT_EQ(world.dispatcher().getNumManifolds(), 1);
    return *world.dispatcher().getManifoldByIndexInternal(0);
  }

  BulletPenetrationDepthSolver solver;
  BulletWorld world;
};

btTransform at(const btVector3& place) { return btTransform(btQuaternion::getIdentity(), place); }

TEST(Plane, AFaceLiesDownInOneStep) {
  for (const bool plane_first : {true, false}) {
    PlaneWorld scene;
    if (plane_first) scene.plane();
    auto* box = scene.world.shape<btBoxShape>(vector(.5, .3, .4));
    scene.moving(box, at(vector(0, .299, 0)));
    if (!plane_first) scene.plane();
    scene.step();
    EXPECT_EQ(scene.solver.statistics().calls, 1);
    const btPersistentManifold& manifold = scene.only_manifold();
    ASSERT_EQ(manifold.getNumContacts(), 4);
    for (int i = 0; i < 4; ++i) {
      // Sharp, as Bullet takes boxes on planes.
      const btManifoldPoint& point = manifold.getContactPoint(i);
      const btVector3& on_box =
          manifold.getBody0()->getCollisionShape() == box ? point.m_localPointA : point.m_localPointB;
      EXPECT_NEAR(std::abs(static_cast<double>(on_box.x())), .5, 1e-6);
      EXPECT_NEAR(std::abs(static_cast<double>(on_box.z())), .4, 1e-6);
      EXPECT_NEAR(static_cast<double>(point.getDistance()), -.001, 1e-6);
    }
  }
}

TEST(Plane, HeightsOfRestAreBullets) {
  // A plane that is turned, off the origin and moved with its body.
  for (const bool ours : {false, true}) {
    PlaneWorld scene(ours);
    scene.plane(vector(0, 1, 0), .5)->setWorldTransform(at(vector(0, -.25, 0)));
    auto* hull = scene.world.shape<btConvexHullShape>();
    for (const double x : {-.3, .3}) {
      for (const double z : {-.3, .3}) hull->addPoint(vector(x, -.2, z));
    }
    hull->addPoint(vector(0, .4, 0));
    const std::vector<std::pair<btCollisionShape*, double>> bodies{
        {scene.world.shape<btBoxShape>(vector(.3, .2, .3)), .2},
        {scene.world.shape<btSphereShape>(btScalar(.3)), .3},
        {scene.world.shape<btCapsuleShape>(btScalar(.2), btScalar(.4)), .4},
        {scene.world.shape<btCylinderShape>(vector(.3, .25, .3)), .25},
        {hull, .24}};
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      scene.moving(bodies[i].first, at(vector(2 * static_cast<double>(i), .25 + bodies[i].second + .05, 0)));
    }
    scene.step(120);
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const double height = static_cast<double>(scene.world.bodies()[i + 1]->getWorldTransform().getOrigin().y());
      EXPECT_NEAR(height, .25 + bodies[i].second, 2e-3) << i << (ours ? " ours" : " Bullet's");
    }
  }
}

TEST(Plane, ABoxHoldsOnASlope) {
  const double turn = .4;
  PlaneWorld scene;
  const btVector3 normal = vector(-std::sin(turn), std::cos(turn), 0);
  scene.plane(normal);
  btRigidBody* box = scene.moving(scene.world.shape<btBoxShape>(vector(.5, .3, .4)),
                                  btTransform(btQuaternion(vector(0, 0, 1), btScalar(turn)), btScalar(.3) * normal));
  scene.step(60);
  const btVector3 start = box->getWorldTransform().getOrigin();
  scene.step(1200);
  // Bullet's box creeps by 4e-5 m.
  EXPECT_LT(static_cast<double>((box->getWorldTransform().getOrigin() - start).length()), 5e-6);
}

TEST(Plane, ATowerOfTenStands) {
  // Under Bullet's algorithms it falls after ten seconds.
  PlaneWorld scene;
  scene.plane();
  for (int i = 0; i < 10; ++i)
    scene.moving(scene.world.shape<btBoxShape>(vector(.5, .5, .5)), at(vector(0, i + .5, 0)));
  scene.step(1800);
  const btVector3 top = scene.world.bodies().back()->getWorldTransform().getOrigin();
  EXPECT_LT(std::hypot(static_cast<double>(top.x()), static_cast<double>(top.z())), .2);
  EXPECT_NEAR(static_cast<double>(top.y()), 9.5, .05);
}

TEST(Plane, BelowIsInside) {
  PlaneWorld scene;
  scene.plane();
  scene.moving(scene.world.shape<btSphereShape>(btScalar(.5)), at(vector(0, -5, 0)));
  scene.step();
  const btPersistentManifold& manifold = scene.only_manifold();
  ASSERT_EQ(manifold.getNumContacts(), 1);
  EXPECT_NEAR(static_cast<double>(manifold.getContactPoint(0).getDistance()), -5.5, 1e-2);
  EXPECT_NEAR(static_cast<double>(manifold.getContactPoint(0).m_normalWorldOnB.y()), 1, 1e-6);
}

TEST(Plane, ChildrenOfCompounds) {
  PlaneWorld scene;
  scene.plane();
  auto* dumbbell = scene.world.shape<btCompoundShape>();
  auto* end = scene.world.shape<btBoxShape>(vector(.2, .2, .2));
  dumbbell->addChildShape(at(vector(-.6, 0, 0)), end);
  dumbbell->addChildShape(at(vector(.6, 0, 0)), end);
  btRigidBody* body = scene.moving(dumbbell, at(vector(0, .25, 0)));
  scene.step(120);
  EXPECT_NEAR(static_cast<double>(body->getWorldTransform().getOrigin().y()), .2, 2e-3);
  // Two at each end, chosen together.
  EXPECT_EQ(scene.world.num_contacts(), 4);
}

TEST(Plane, WhatHasNoExactFormIsBullets) {
  PlaneWorld scene;
  scene.plane();
  const btVector3 centres[] = {vector(-.2, 0, 0), vector(.2, 0, 0)};
  const btScalar radii[] = {btScalar(.2), btScalar(.1)};
  auto* spheres = scene.world.shape<btMultiSphereShape>(centres, radii, 2);
  spheres->setLocalScaling(vector(1, 2, 1));
  btRigidBody* body = scene.moving(spheres, at(vector(0, .5, 0)));
  scene.step(60);
  EXPECT_GT(static_cast<double>(body->getWorldTransform().getOrigin().y()), .1);
  EXPECT_GT(scene.world.num_contacts(), 0);
}

TEST(Plane, OptingOutAndUninstalling) {
  BulletSolverSettings settings;
  settings.takes_pair = [](const btCollisionObject&, const btCollisionObject&, void*) { return false; };
  PlaneWorld left(true, settings);
  left.plane();
  left.moving(left.world.shape<btBoxShape>(vector(.5, .3, .4)), at(vector(0, .299, 0)));
  left.step();
  EXPECT_EQ(left.solver.statistics().calls, 0);

  PlaneWorld given_back;
  given_back.plane();
  given_back.moving(given_back.world.shape<btBoxShape>(vector(.5, .3, .4)), at(vector(0, .299, 0)));
  given_back.step();
  EXPECT_TRUE(uninstall(given_back.world.world(), given_back.solver));
  given_back.solver.reset_statistics();
  given_back.step(30);
  EXPECT_EQ(given_back.solver.statistics().calls, 0);
  EXPECT_GT(given_back.world.num_contacts(), 0);
}

TEST(Plane, AReplayIsBitForBit) {
  PlaneWorld scene;
  scene.plane();
  for (int i = 0; i < 6; ++i) {
    scene.moving(scene.world.shape<btBoxShape>(vector(.3, .2 + .02 * i, .25)),
                 btTransform(btQuaternion(vector(1, 2, i).normalized(), btScalar(.3 * i)),
                             vector(.4 * (i % 2), .5 + .6 * i, 0)));
  }
  scene.step(45);
  const BulletSnapshot saved(scene.world.world(), &scene.solver);
  const auto poses = [&] {
    scene.step(40);
    std::vector<btTransform> result;
    for (const auto& body : scene.world.bodies()) result.push_back(body->getWorldTransform());
    return result;
  };
  const std::vector<btTransform> first = poses();
  ASSERT_EQ(saved.restore(), Restored::yes);
  const std::vector<btTransform> second = poses();
  for (std::size_t i = 0; i < first.size(); ++i) EXPECT_TRUE(first[i] == second[i]) << i;
}

TEST(Plane, PosesThatAreNoNumbersHaveNoContacts) {
  PlaneWorld scene;
  scene.plane();
  btRigidBody* body = scene.moving(scene.world.shape<btBoxShape>(vector(.5, .3, .4)), at(vector(0, .299, 0)));
  scene.step();
  ASSERT_EQ(scene.world.num_contacts(), 4);
  btTransform broken = body->getWorldTransform();
  broken.setOrigin(vector(0, std::nan(""), 0));
  body->setWorldTransform(broken);
  scene.world.dispatcher().dispatchAllCollisionPairs(scene.world.world().getPairCache(),
                                                     scene.world.world().getDispatchInfo(), &scene.world.dispatcher());
  EXPECT_EQ(scene.world.num_contacts(), 0);
}

}  // namespace
}  // namespace pd::test
