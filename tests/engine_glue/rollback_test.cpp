// Fast bodies meet at their first contact, not inside each other and not behind each other.
#include "pd/bullet/rollback.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "engine_glue/bullet_world.hpp"
#include "pd/bullet/install.hpp"

namespace pd::test {
namespace {

const btScalar kStep = btScalar(1.0 / 60);

class Rollback : public ::testing::Test {
 protected:
  BulletPenetrationDepthSolver solver;
  BulletWorld scene;

  Rollback() {
    install(scene.world(), solver);
    scene.world().setGravity(btVector3(0, 0, 0));
  }
};

TEST_F(Rollback, StopsAtTheKnownTime) {
  auto* hull = box_hull(scene, btVector3(btScalar(0.5), btScalar(0.5), btScalar(0.5)), 0);
  scene.body(hull, 0, btVector3(0, 0, 0));
  btRigidBody* ball = scene.body(scene.shape<btSphereShape>(btScalar(0.25)), 1, btVector3(2, 0, 0));
  ball->setLinearVelocity(btVector3(-100, 0, 0));
  ball->setRestitution(1);
  RollbackStepper stepper(scene.world(), solver);
  const RollbackReport report = stepper.step(kStep);  // free flight would end at 0.333, 0.417 deep
  ASSERT_EQ(report.contacts.size(), 1);
  const FirstContact& contact = report.contacts[0];
  EXPECT_NEAR(contact.time, 1.25 / 100, 1e-6);
  EXPECT_GT(contact.gap, 0);
  EXPECT_LE(contact.gap, 1e-5);
  EXPECT_NEAR(contact.undone_depth, 0.25 + 0.5 - (2 - 100.0 / 60), 1e-4);
  EXPECT_LE(contact.trials, 4);
  // The contact object decides who is A: the way in which the ball leaves the wall is +x.
  const btVector3 way_out = contact.body_a == ball ? contact.normal : -contact.normal;
  EXPECT_NEAR(static_cast<double>(way_out.x()), 1, 1e-6);
  EXPECT_NEAR(static_cast<double>((contact.point_a - contact.point_b).length()), contact.gap, 1e-6);
  EXPECT_GE(static_cast<double>(ball->getWorldTransform().getOrigin().x()), 0.75 - 1e-5);
}

TEST_F(Rollback, MeetsWhatItWouldPassThrough) {
  auto* wall = scene.shape<btBoxShape>(btVector3(btScalar(0.01), 2, 2));
  wall->setMargin(0);
  scene.body(wall, 0, btVector3(0, 0, 0));
  auto* box = scene.shape<btBoxShape>(btVector3(btScalar(0.05), btScalar(0.05), btScalar(0.05)));
  box->setMargin(0);
  btRigidBody* bullet = scene.body(box, 1, btVector3(1, 0, 0));
  bullet->setLinearVelocity(btVector3(-200, 0, 0));
  bullet->setAngularVelocity(btVector3(0, 0, 5));
  RollbackStepper stepper(scene.world(), solver);
  const RollbackReport report = stepper.step(kStep);
  ASSERT_GE(report.contacts.size(), 1);
  EXPECT_EQ(report.contacts[0].undone_depth, 0);  // at the end of the plain step it is behind the wall
  EXPECT_LE(report.contacts[0].gap, 1e-5);
  for (int i = 0; i < 30; ++i) {
    stepper.step(kStep);
    EXPECT_GT(static_cast<double>(bullet->getWorldTransform().getOrigin().x()), 0) << i;
  }
}

TEST_F(Rollback, TwoBodiesInOneStepInOrder) {
  auto* hull = box_hull(scene, btVector3(btScalar(0.5), btScalar(0.5), btScalar(0.5)), 0);
  scene.body(hull, 0, btVector3(0, 0, 0));
  auto* sphere = scene.shape<btSphereShape>(btScalar(0.25));
  btRigidBody* early = scene.body(sphere, 1, btVector3(btScalar(1.25), 0, 0));
  btRigidBody* late = scene.body(sphere, 1, btVector3(0, btScalar(1.75), 0));
  early->setLinearVelocity(btVector3(-100, 0, 0));
  late->setLinearVelocity(btVector3(0, -100, 0));
  RollbackStepper stepper(scene.world(), solver);
  const RollbackReport report = stepper.step(kStep);
  ASSERT_EQ(report.contacts.size(), 2);
  EXPECT_NEAR(report.contacts[0].time, 0.005, 1e-6);
  EXPECT_NEAR(report.contacts[1].time, 0.010, 1e-6);
}

TEST_F(Rollback, WithoutContactItIsBulletsOwnStep) {
  auto* sphere = scene.shape<btSphereShape>(btScalar(0.25));
  btRigidBody* body = scene.body(sphere, 1, btVector3(0, 0, 0));
  body->setLinearVelocity(btVector3(1, 2, 3));
  BulletWorld plain;
  plain.world().setGravity(btVector3(0, 0, 0));
  btRigidBody* twin = plain.body(plain.shape<btSphereShape>(btScalar(0.25)), 1, btVector3(0, 0, 0));
  twin->setLinearVelocity(btVector3(1, 2, 3));
  RollbackStepper stepper(scene.world(), solver);
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(stepper.step(kStep).simulation_steps, 1);
    plain.world().stepSimulation(kStep, 0);
  }
  EXPECT_EQ(body->getWorldTransform(), twin->getWorldTransform());
}

TEST_F(Rollback, RestingContactsAreLeftToBullet) {
  scene.world().setGravity(btVector3(0, btScalar(-9.81), 0));
  auto* box = scene.shape<btBoxShape>(btVector3(1, 1, 1));
  box->setMargin(0);
  scene.body(box, 0, btVector3(0, 0, 0));
  btRigidBody* top = scene.body(box, 1, btVector3(0, 2, 0));
  RollbackStepper stepper(scene.world(), solver);
  int trials = 0;
  for (int i = 0; i < 60; ++i) {
    trials += stepper.step(kStep).simulation_steps;
  }
  EXPECT_LT(trials, 90);
  EXPECT_NEAR(static_cast<double>(top->getWorldTransform().getOrigin().y()), 2, 0.02);
}

}  // namespace
}  // namespace pd::test
