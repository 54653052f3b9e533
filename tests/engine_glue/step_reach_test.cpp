// Points that are apart are handed to Bullet where the bodies may close their gaps in the step, and not otherwise.
#include "pair/step_reach.hpp"

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <btBulletDynamicsCommon.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "pd/bullet/install.hpp"

namespace pd::test {
namespace {

enum class Kind { box, compound };

/// A box of a metre over a floor, or four quarters of one.
struct Hovering {
  explicit Hovering(btScalar gap, int floor_flags = btCollisionObject::CF_STATIC_OBJECT, Kind kind = Kind::box) {
    world.setGravity(btVector3(0, -10, 0));
    install(world, solver);
    for (const btScalar x : {btScalar(-0.25), btScalar(0.25)}) {
      for (const btScalar z : {btScalar(-0.25), btScalar(0.25)}) {
        quarters.addChildShape(btTransform(btQuaternion::getIdentity(), btVector3(x, 0, z)), &quarter);
      }
    }
    if (kind == Kind::compound) body.setCollisionShape(&quarters);
    floor.setCollisionShape(&ground);
    floor.setWorldTransform(btTransform(btQuaternion::getIdentity(), btVector3(0, -1, 0)));
    floor.setCollisionFlags(floor_flags);
    world.addCollisionObject(&floor);
    body.setWorldTransform(btTransform(btQuaternion::getIdentity(), btVector3(0, btScalar(0.5) + gap, 0)));
    body.setActivationState(DISABLE_DEACTIVATION);
    world.addRigidBody(&body);
  }
  ~Hovering() {
    world.removeRigidBody(&body);
    world.removeCollisionObject(&floor);
  }

  void step() { world.stepSimulation(btScalar(1) / 60, 0); }
  [[nodiscard]] int points() {
    int count = 0;
    for (int i = 0; i < dispatcher.getNumManifolds(); ++i) {
      count += dispatcher.getManifoldByIndexInternal(i)->getNumContacts();
    }
    return count;
  }
  [[nodiscard]] btScalar rightmost() {
    btScalar most = -1;
    for (int i = 0; i < dispatcher.getNumManifolds(); ++i) {
      const btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal(i);
      for (int k = 0; k < manifold.getNumContacts(); ++k) {
        most = std::max(most, manifold.getContactPoint(k).getPositionWorldOnB().x());
      }
    }
    return most;
  }
  [[nodiscard]] btScalar gap() const { return body.getCenterOfMassPosition().y() - btScalar(0.5); }

  BulletPenetrationDepthSolver solver;
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver constraints;
  btDiscreteDynamicsWorld world{&dispatcher, &broadphase, &constraints, &configuration};
  btBoxShape ground{btVector3(5, 1, 5)};
  btBoxShape cube{btVector3(btScalar(0.5), btScalar(0.5), btScalar(0.5))};
  btBoxShape quarter{btVector3(btScalar(0.25), btScalar(0.5), btScalar(0.25))};
  btCompoundShape quarters;
  btCollisionObject floor;
  btRigidBody body{btRigidBody::btRigidBodyConstructionInfo(1, nullptr, &cube, btVector3(1, 1, 1))};
};

/// Of the pair: Bullet's own threshold for a box of a metre.
btScalar threshold() {
  const btBoxShape cube(btVector3(btScalar(0.5), btScalar(0.5), btScalar(0.5)));
  return cube.getContactBreakingThreshold(gContactBreakingThreshold);
}

TEST(StepReach, WhatGravityAloneDoesNotCloseHasNoPoints) {
  Hovering far(btScalar(0.9) * threshold());
  far.step();
  EXPECT_EQ(far.points(), 0);
  Hovering near(btScalar(0.2) * threshold());
  near.step();
  EXPECT_EQ(near.points(), 4);
  // The body is a brick beside another one in a wall.
  Hovering beside(btScalar(0.1) * threshold());
  beside.world.setGravity(btVector3(0, 0, 0));
  beside.step();
  EXPECT_EQ(beside.points(), 0);
}

TEST(StepReach, WhatComesFastHasPoints) {
  Hovering coming(btScalar(0.9) * threshold());
  coming.body.setLinearVelocity(btVector3(0, -1, 0));
  coming.step();
  EXPECT_EQ(coming.points(), 4);
  Hovering going(btScalar(0.9) * threshold());
  going.body.setLinearVelocity(btVector3(0, 1, 0));
  going.step();
  EXPECT_EQ(going.points(), 0);
  Hovering pressed(btScalar(0.9) * threshold());
  pressed.body.applyCentralForce(btVector3(0, -100, 0));
  pressed.step();
  EXPECT_EQ(pressed.points(), 4);
}

/// A box that turns about z comes down on one side only.
TEST(StepReach, OnlyTheSideThatComesHasPoints) {
  Hovering turning(btScalar(0.9) * threshold());
  turning.world.setGravity(btVector3(0, 0, 0));
  turning.body.setAngularVelocity(btVector3(0, 0, btScalar(2)));
  turning.step();
  EXPECT_EQ(turning.points(), 2);
}

/// Two boxes that fly as one at this speed, along the normal of their contact. One is tilted over the other, so that an
/// edge is near and the one across it is not.
int points_of_tilted_pair(btScalar speed) {
  Hovering pair(10);
  pair.world.setGravity(btVector3(0, 0, 0));
  const btScalar near = btScalar(0.01) * threshold(), tilt = btScalar(0.8) * threshold();
  const btVector3 at = pair.body.getCenterOfMassPosition();
  const btScalar below = btScalar(0.5) * (1 + btCos(tilt) + btSin(tilt)) + near;
  btRigidBody other(btRigidBody::btRigidBodyConstructionInfo(1, nullptr, &pair.cube, btVector3(1, 1, 1)));
  pair.body.setWorldTransform(btTransform(btQuaternion(btVector3(0, 0, 1), tilt), at));
  other.setWorldTransform(btTransform(btQuaternion::getIdentity(), at - btVector3(0, below, 0)));
  pair.world.addRigidBody(&other);
  for (btRigidBody* const body : {&pair.body, &other}) {
    body->setGravity(btVector3(0, 0, 0));
    body->setLinearVelocity(btVector3(0, -speed, 0));
  }
  pair.step();
  const int points = pair.points();
  pair.world.removeRigidBody(&other);
  return points;
}

/// If the lower box is stopped, the near edge holds the upper one, unless they are so fast that it would turn far.
TEST(StepReach, ANearPointHoldsThePairForTheOthers) {
  EXPECT_EQ(points_of_tilted_pair(1), 2);
  EXPECT_EQ(points_of_tilted_pair(4), 4);
}

TEST(StepReach, HostsThatReadPointsGetThemAll) {
  Hovering sensor(btScalar(0.9) * threshold(), btCollisionObject::CF_NO_CONTACT_RESPONSE);
  sensor.step();
  EXPECT_EQ(sensor.points(), 4);

  struct Count : btCollisionWorld::ContactResultCallback {
    int points = 0;
    btScalar addSingleResult(btManifoldPoint&, const btCollisionObjectWrapper*, int, int,
                             const btCollisionObjectWrapper*, int, int) override {
      ++points;
      return 0;
    }
  } asked;
  asked.m_closestDistanceThreshold = threshold();
  Hovering tested(btScalar(0.9) * threshold());
  tested.world.contactPairTest(&tested.body, &tested.floor, asked);
  EXPECT_EQ(asked.points, 4);
}

TEST(StepReach, ChildrenOfCompoundsHaveThePointsThatCanBeNeeded) {
  constexpr int kFixed = btCollisionObject::CF_STATIC_OBJECT;
  const btScalar far = btScalar(0.9) * threshold();
  Hovering idle(far, kFixed, Kind::compound);
  idle.step();
  EXPECT_EQ(idle.points(), 0);
  EXPECT_EQ(idle.solver.statistics().calls, 0);
  Hovering near(btScalar(0.2) * threshold(), kFixed, Kind::compound);
  near.step();
  EXPECT_EQ(near.points(), 4);
  Hovering coming(far, kFixed, Kind::compound);
  coming.body.setLinearVelocity(btVector3(0, -1, 0));
  coming.step();
  EXPECT_EQ(coming.points(), 4);
  Hovering sliding(far, kFixed, Kind::compound);
  sliding.body.setLinearVelocity(btVector3(10, 0, 0));
  sliding.step();
  EXPECT_EQ(sliding.points(), 0);
  Hovering turning(far, kFixed, Kind::compound);
  turning.world.setGravity(btVector3(0, 0, 0));
  turning.body.setAngularVelocity(btVector3(0, 0, btScalar(2)));
  turning.step();
  EXPECT_EQ(turning.points(), 3);
  EXPECT_LT(turning.rightmost(), btScalar(-0.4));
  Hovering sensor(far, btCollisionObject::CF_STATIC_OBJECT | btCollisionObject::CF_NO_CONTACT_RESPONSE, Kind::compound);
  sensor.step();
  EXPECT_EQ(sensor.points(), 4);
}

/// A point that was left out is there in the step in which the body arrives.
TEST(StepReach, NothingFallsThroughTheGap) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> share(0, 1);
  for (int i = 0; i < 400; ++i) {
    Hovering falling(static_cast<btScalar>(share(random)) * threshold(), btCollisionObject::CF_STATIC_OBJECT,
                     i % 2 == 0 ? Kind::box : Kind::compound);
    const double shares[] = {share(random), share(random)};
    falling.body.setLinearVelocity(btVector3(0, static_cast<btScalar>(-4 * shares[0] * shares[1]), 0));
    btScalar deepest = 0;
    for (int k = 0; k < 20; ++k) {
      falling.step();
      deepest = std::max(deepest, -falling.gap());
    }
    EXPECT_LE(deepest, btScalar(1e-4)) << i;
    EXPECT_NEAR(falling.gap(), 0, 1e-3) << i;
  }
}

}  // namespace
}  // namespace pd::test
