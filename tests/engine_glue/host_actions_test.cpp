// Actions of the host (vehicles, character controllers) are called for the parts of a step that count, and for no
// trial.
#include <BulletCollision/CollisionDispatch/btGhostObject.h>
#include <BulletDynamics/Character/btKinematicCharacterController.h>
#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "engine_glue/bullet_world.hpp"
#include "pd/bullet/install.hpp"
#include "pd/bullet/rollback.hpp"

namespace pd::test {
namespace {

const btScalar kStep = btScalar(1.0 / 60);

class HostActions : public ::testing::Test {
 protected:
  BulletPenetrationDepthSolver solver;
  BulletWorld scene;

  HostActions() { install(scene.world(), solver); }

  /// A ball that flies to and fro between two walls, so that steps are cut.
  void cut_steps() {
    auto* wall = scene.shape<btBoxShape>(btVector3(1, 3, 3));
    wall->setMargin(0);
    for (const btScalar x : {btScalar(-3), btScalar(3)}) {
      scene.body(wall, 0, btVector3(x, 50, 0))->setRestitution(1);
    }
    btRigidBody* ball = scene.body(scene.shape<btSphereShape>(btScalar(0.2)), 1, btVector3(0, 50, 0));
    ball->setGravity(btVector3(0, 0, 0));
    ball->setFlags(ball->getFlags() | BT_DISABLE_WORLD_GRAVITY);
    ball->setLinearVelocity(btVector3(60, 0, 0));
    ball->setRestitution(1);
    ball->setActivationState(DISABLE_DEACTIVATION);
  }
};

/// Pushes a body in every third step, and says when it is called.
struct Push : btActionInterface {
  btRigidBody* body = nullptr;
  int calls = 0;
  double time = 0;
  void updateAction(btCollisionWorld*, btScalar step) override {
    time += static_cast<double>(step);
    if (++calls % 3 == 0 && body != nullptr && calls < 120) {
      body->activate();
      body->applyCentralImpulse(btVector3(btScalar(0.02), 0, btScalar(0.01)));
    }
  }
  void debugDraw(btIDebugDraw*) override {}
};

TEST_F(HostActions, OncePerPartThatCounts) {
  cut_steps();
  Push push;
  scene.world().addAction(&push);
  RollbackStepper stepper(scene.world(), solver);
  int parts = 0;
  int trials = 0;
  for (int i = 0; i < 60; ++i) {
    const RollbackReport report = stepper.step(kStep);
    parts += report.parts;
    trials += report.simulation_steps;
  }
  EXPECT_GT(parts, 70);
  EXPECT_GT(trials, parts);
  EXPECT_EQ(push.calls, parts);
  EXPECT_NEAR(push.time, 1, 1e-5);
  scene.world().removeAction(&push);
}

// Bullet decides what sleeps after actions: poses, activation and times at rest are its own, to the bit.
TEST_F(HostActions, WhereNothingIsCutTheWorldIsBullets) {
  const auto fill = [](BulletWorld& world, Push& push) {
    auto* floor = world.shape<btBoxShape>(btVector3(5, 1, 5));
    floor->setMargin(0);
    world.body(floor, 0, btVector3(0, -1, 0));
    auto* box = world.shape<btBoxShape>(btVector3(btScalar(0.5), btScalar(0.5), btScalar(0.5)));
    box->setMargin(0);
    push.body = world.body(box, 1, btVector3(0, btScalar(0.5), 0));
    world.body(box, 1, btVector3(3, btScalar(0.5), 0));
    world.world().addAction(&push);
  };
  Push push;
  fill(scene, push);
  BulletWorld plain;
  BulletPenetrationDepthSolver own;
  install(plain.world(), own);
  Push twin;
  fill(plain, twin);
  RollbackStepper stepper(scene.world(), solver);
  bool slept = false;
  for (int i = 0; i < 420; ++i) {
    ASSERT_EQ(stepper.step(kStep).simulation_steps, 1) << i;
    plain.world().stepSimulation(kStep, 0);
    ASSERT_EQ(push.body->getWorldTransform(), twin.body->getWorldTransform()) << i;
    ASSERT_EQ(push.body->getLinearVelocity(), twin.body->getLinearVelocity()) << i;
    ASSERT_EQ(push.body->getActivationState(), twin.body->getActivationState()) << i;
    ASSERT_EQ(push.body->getDeactivationTime(), twin.body->getDeactivationTime()) << i;
    slept = slept || push.body->getActivationState() == ISLAND_SLEEPING;
  }
  EXPECT_TRUE(slept);
  scene.world().removeAction(&push);
  plain.world().removeAction(&twin);
}

TEST_F(HostActions, ACharacterWalksByItsTime) {
  cut_steps();
  btGhostPairCallback pairs;
  scene.world().getPairCache()->setInternalGhostPairCallback(&pairs);
  auto* ground = scene.shape<btBoxShape>(btVector3(20, 1, 20));
  scene.body(ground, 0, btVector3(0, -1, 0));
  auto* capsule = scene.shape<btCapsuleShape>(btScalar(0.3), btScalar(1));
  btPairCachingGhostObject ghost;
  ghost.setWorldTransform(btTransform(btQuaternion::getIdentity(), btVector3(0, btScalar(0.85), 0)));
  ghost.setCollisionShape(capsule);
  ghost.setCollisionFlags(btCollisionObject::CF_CHARACTER_OBJECT);
  scene.world().addCollisionObject(&ghost, btBroadphaseProxy::CharacterFilter,
                                   btBroadphaseProxy::StaticFilter | btBroadphaseProxy::DefaultFilter);
  btKinematicCharacterController walker(&ghost, capsule, btScalar(0.3), btVector3(0, 1, 0));
  scene.world().addAction(&walker);
  walker.setVelocityForTimeInterval(btVector3(2, 0, 0), 10);
  RollbackStepper stepper(scene.world(), solver);
  int trials = 0;
  for (int i = 0; i < 60; ++i) trials += stepper.step(kStep).simulation_steps;
  EXPECT_GT(trials, 80);
  EXPECT_NEAR(static_cast<double>(ghost.getWorldTransform().getOrigin().x()), 2, 0.01);
  scene.world().removeAction(&walker);
  scene.world().removeCollisionObject(&ghost);
  scene.world().getPairCache()->setInternalGhostPairCallback(nullptr);
}

/// Takes bodies out of the world and deletes them, and puts others in their place, as games do.
struct Replace : btActionInterface {
  explicit Replace(btDiscreteDynamicsWorld& of) : world(of) {}
  ~Replace() override {
    for (const auto& body : bodies) world.removeRigidBody(body.get());
  }
  void add(double x, bool kinematic) {
    btRigidBody::btRigidBodyConstructionInfo info(kinematic ? 0 : 1, nullptr, &ball, btVector3(1, 1, 1));
    info.m_startWorldTransform.setIdentity();
    info.m_startWorldTransform.setOrigin(btVector3(btScalar(x), 20, 0));
    bodies.push_back(std::make_unique<btRigidBody>(info));
    btRigidBody& body = *bodies.back();
    if (kinematic) body.setCollisionFlags(body.getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
    body.setActivationState(DISABLE_DEACTIVATION);
    world.addRigidBody(&body);
    if (!kinematic) body.applyCentralForce(btVector3(0, 3, 0));
  }
  void replace() {
    ++calls;
    world.removeRigidBody(bodies.front().get());
    bodies.erase(bodies.begin());
    if (calls % 3 != 0) add(calls % 7, calls % 2 == 0);
    if (bodies.size() < 2) add(calls % 5, false);
  }
  void updateAction(btCollisionWorld*, btScalar) override {
    if (in_action) replace();
  }
  void debugDraw(btIDebugDraw*) override {}
  btDiscreteDynamicsWorld& world;
  btSphereShape ball{btScalar(0.2)};
  std::vector<std::unique_ptr<btRigidBody>> bodies;
  bool in_action = true;
  int calls = 0;
};

enum class CalledBy { action, pre_tick, tick };

/// Bullet lets actions and tick callbacks take bodies out of the world, also in the middle of a step that is cut. The
/// address sanitizer watches here.
class HostActionsReplace : public HostActions, public ::testing::WithParamInterface<CalledBy> {};

TEST_P(HostActionsReplace, BodiesInStepsThatAreCut) {
  Replace host(scene.world());
  host.in_action = GetParam() == CalledBy::action;
  for (int i = 0; i < 6; ++i) host.add(i, i % 2 == 0);
  cut_steps();
  if (host.in_action) {
    scene.world().addAction(&host);
  } else {
    const auto callback = [](btDynamicsWorld* world, btScalar) {
      static_cast<Replace*>(world->getWorldUserInfo())->replace();
    };
    scene.world().setInternalTickCallback(callback, &host, GetParam() == CalledBy::pre_tick);
  }
  RollbackStepper stepper(scene.world(), solver);
  int cuts = 0;
  for (int i = 0; i < 60; ++i) {
    host.bodies.back()->applyCentralForce(btVector3(1, 0, 0));
    cuts += stepper.step(kStep).parts - 1;
  }
  EXPECT_GT(cuts, 5);
  EXPECT_GT(host.calls, 60);
  scene.world().removeAction(&host);
  scene.world().setInternalTickCallback(nullptr, nullptr, GetParam() == CalledBy::pre_tick);
}

INSTANTIATE_TEST_SUITE_P(Everywhere, HostActionsReplace,
                         ::testing::Values(CalledBy::action, CalledBy::pre_tick, CalledBy::tick));

}  // namespace
}  // namespace pd::test
