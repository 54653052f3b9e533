// Bodies that nothing touches fly as such bodies do: parabolas, free turning, bounces in the middle of a step.
#include <gtest/gtest.h>

#include <cmath>

#include "engine_glue/bullet_world.hpp"
#include "pd/bullet/install.hpp"
#include "pd/bullet/rollback.hpp"

namespace pd::test {
namespace {

const btScalar kStep = btScalar(1.0 / 60);
constexpr double kGravity = 9.81;

class FreeFlight : public ::testing::Test {
 protected:
  BulletPenetrationDepthSolver solver;
  BulletWorld scene;

  FreeFlight() { install(scene.world(), solver); }

  btRigidBody* thrown(btCollisionShape* shape, const btVector3& at, const btVector3& velocity) {
    btRigidBody* body = scene.body(shape, 1, at);
    body->setLinearVelocity(velocity);
    body->setRestitution(1);
    body->setFriction(0);
    body->setActivationState(DISABLE_DEACTIVATION);
    return body;
  }
  void floor() {
    auto* box = scene.shape<btBoxShape>(btVector3(5, 1, 5));
    box->setMargin(0);
    scene.body(box, 0, btVector3(0, -1, 0))->setRestitution(1);
  }
  static double height(const btRigidBody& body) {
    return static_cast<double>(body.getWorldTransform().getOrigin().y());
  }
  static double speed_up(const btRigidBody& body) { return static_cast<double>(body.getLinearVelocity().y()); }
};

/// Twice the kinetic energy of the turning, and the angular momentum.
double spin_energy(const btRigidBody& body, btVector3& momentum) {
  const btVector3 spin = body.getAngularVelocity() * body.getWorldTransform().getBasis();
  const btVector3 local = spin / body.getInvInertiaDiagLocal();
  momentum = body.getWorldTransform().getBasis() * local;
  return static_cast<double>(spin.dot(local));
}

TEST_F(FreeFlight, ADroppedBallComesBackToItsHeight) {
  floor();
  btRigidBody* ball =
      thrown(scene.shape<btSphereShape>(btScalar(0.1)), btVector3(0, btScalar(1.1), 0), btVector3(0, 0, 0));
  RollbackStepper stepper(scene.world(), solver);
  double highest = 0;
  int contacts = 0;
  for (int i = 0; i < 600; ++i) {
    contacts += stepper.step(kStep).contacts.size();
    const double energy = kGravity * (height(*ball) - 0.1) + 0.5 * speed_up(*ball) * speed_up(*ball);
    ASSERT_NEAR(energy, kGravity, 1e-3 * kGravity) << i;
    highest = std::max(i < 540 ? 0 : highest, height(*ball) - 0.1);
  }
  EXPECT_EQ(contacts, 11);
  EXPECT_GT(highest, 0.99);  // of the last bounce: an apex falls between two steps
}

TEST_F(FreeFlight, FlightIsAParabola) {
  btRigidBody* ball = thrown(scene.shape<btSphereShape>(btScalar(0.1)), btVector3(0, 0, 0), btVector3(3, 7, 0));
  btRigidBody* pushed = thrown(scene.shape<btSphereShape>(btScalar(0.1)), btVector3(0, 0, 5), btVector3(0, 0, 0));
  RollbackStepper stepper(scene.world(), solver);
  for (int i = 0; i < 60; ++i) {
    pushed->applyCentralForce(btVector3(4, btScalar(kGravity), 0));
    EXPECT_EQ(stepper.step(kStep).simulation_steps, 1);
  }
  EXPECT_NEAR(static_cast<double>(ball->getWorldTransform().getOrigin().x()), 3, 1e-5);
  EXPECT_NEAR(height(*ball), 7 - 0.5 * kGravity, 2e-5);  // Bullet: .08 lower
  EXPECT_NEAR(static_cast<double>(pushed->getWorldTransform().getOrigin().x()), 2, 1e-5);
  EXPECT_NEAR(height(*pushed), 0, 1e-5);
}

TEST_F(FreeFlight, WithoutItFlightIsBullets) {
  btRigidBody* body = thrown(scene.shape<btBoxShape>(btVector3(btScalar(0.1), btScalar(0.2), btScalar(0.4))),
                             btVector3(0, 0, 0), btVector3(3, 7, 0));
  body->setAngularVelocity(btVector3(1, 5, btScalar(0.1)));
  BulletWorld plain;
  btRigidBody* twin = plain.body(plain.shape<btBoxShape>(btVector3(btScalar(0.1), btScalar(0.2), btScalar(0.4))), 1,
                                 btVector3(0, 0, 0));
  twin->setLinearVelocity(btVector3(3, 7, 0));
  twin->setAngularVelocity(btVector3(1, 5, btScalar(0.1)));
  RollbackSettings settings;
  settings.exact_flight = false;
  RollbackStepper stepper(scene.world(), solver, settings);
  for (int i = 0; i < 30; ++i) {
    stepper.step(kStep);
    plain.world().stepSimulation(kStep, 0);
    ASSERT_EQ(body->getWorldTransform(), twin->getWorldTransform()) << i;
    ASSERT_EQ(body->getAngularVelocity(), twin->getAngularVelocity()) << i;
  }
}

// About the middle axis, where the motion is unstable: the body turns over and over.
TEST_F(FreeFlight, ABodyOfThreeMomentsKeepsEnergyAndMomentum) {
  btRigidBody* body = thrown(scene.shape<btBoxShape>(btVector3(btScalar(0.1), btScalar(0.2), btScalar(0.4))),
                             btVector3(0, 0, 0), btVector3(0, 0, 0));
  body->setAngularVelocity(btVector3(btScalar(0.05), 8, btScalar(0.05)));
  btVector3 whole;
  const double before = spin_energy(*body, whole);
  RollbackStepper stepper(scene.world(), solver);
  double most_turned = 1;
  for (int i = 0; i < 600; ++i) {
    stepper.step(kStep);
    btVector3 momentum;
    ASSERT_NEAR(spin_energy(*body, momentum), before, 1e-4 * before) << i;  // Bullet: .5 lost
    ASSERT_LE((momentum - whole).length(), btScalar(1e-4) * whole.length()) << i;
    most_turned = std::min(most_turned, static_cast<double>(body->getWorldTransform().getBasis()[1][1]));
  }
  EXPECT_LT(most_turned, -0.9);
}

// The impact at its own time, and a parabola before and after it, wherever in the step it falls.
TEST_F(FreeFlight, ABounceInTheMiddleOfAStep) {
  for (const double share : {0.1, 0.5, 0.9}) {
    SCOPED_TRACE(share);
    const double h = static_cast<double>(kStep);
    const double down = 4;
    const double drop = down * share * h + 0.5 * kGravity * share * share * h * h;
    BulletWorld world;
    BulletPenetrationDepthSolver own;
    install(world.world(), own);
    auto* ground = world.shape<btBoxShape>(btVector3(5, 1, 5));
    ground->setMargin(0);
    world.body(ground, 0, btVector3(0, -1, 0))->setRestitution(1);
    btRigidBody* ball =
        world.body(world.shape<btSphereShape>(btScalar(0.1)), 1, btVector3(0, static_cast<btScalar>(0.1 + drop), 0));
    ball->setLinearVelocity(btVector3(0, static_cast<btScalar>(-down), 0));
    ball->setRestitution(1);
    RollbackStepper stepper(world.world(), own);
    const RollbackReport report = stepper.step(kStep);
    ASSERT_EQ(report.contacts.size(), 1);
    EXPECT_NEAR(report.contacts[0].time, share * h, 1e-5);
    EXPECT_EQ(report.contacts[0].trials, 1);
    const double left = (1 - share) * h;
    const double up = down + kGravity * share * h;
    EXPECT_NEAR(speed_up(*ball), up - kGravity * left, 2e-4);
    EXPECT_NEAR(height(*ball), 0.1 + up * left - 0.5 * kGravity * left * left, 3e-5);
  }
}

// What leaves the floor by less than gravity takes back in the step is not in flight.
TEST_F(FreeFlight, ABodyAtRestIsNotLifted) {
  floor();
  auto* box = scene.shape<btBoxShape>(btVector3(btScalar(0.5), btScalar(0.5), btScalar(0.5)));
  box->setMargin(0);
  btRigidBody* body = thrown(box, btVector3(0, btScalar(0.5), 0), btVector3(0, 0, 0));
  RollbackStepper stepper(scene.world(), solver);
  for (int i = 0; i < 120; ++i) {
    stepper.step(kStep);
    ASSERT_NEAR(height(*body), 0.5, 1e-4) << i;
  }
}

TEST_F(FreeFlight, WhatAJointHoldsIsBullets) {
  auto* shape = scene.shape<btBoxShape>(btVector3(btScalar(0.1), btScalar(0.2), btScalar(0.3)));
  btRigidBody* body = thrown(shape, btVector3(0, 0, 0), btVector3(0, 0, 1));
  btPoint2PointConstraint joint(*body, btVector3(1, 0, 0));
  scene.world().addConstraint(&joint);
  BulletWorld plain;
  btRigidBody* twin = plain.body(shape, 1, btVector3(0, 0, 0));
  twin->setLinearVelocity(btVector3(0, 0, 1));
  btPoint2PointConstraint twins_joint(*twin, btVector3(1, 0, 0));
  plain.world().addConstraint(&twins_joint);
  RollbackStepper stepper(scene.world(), solver);
  for (int i = 0; i < 60; ++i) {
    stepper.step(kStep);
    plain.world().stepSimulation(kStep, 0);
    ASSERT_EQ(body->getWorldTransform(), twin->getWorldTransform()) << i;
  }
  scene.world().removeConstraint(&joint);
  plain.world().removeConstraint(&twins_joint);
}

}  // namespace
}  // namespace pd::test
