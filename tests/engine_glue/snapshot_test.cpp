// A replay after restore gives the same bits.
#include "pd/bullet/snapshot.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <optional>
#include <random>

#include "engine_glue/bullet_world.hpp"
#include "pd/bullet/install.hpp"

namespace pd::test {
namespace {

enum class Contacts { bullet, persistent, one_shot };

struct Record {
  std::vector<btScalar> numbers;
  void add(const btVector3& v) { numbers.insert(numbers.end(), {v.x(), v.y(), v.z()}); }
};

Record record(BulletWorld& scene) {
  Record result;
  for (const auto& body : scene.bodies()) {
    result.add(body->getWorldTransform().getOrigin());
    for (int i = 0; i < 3; ++i) {
      result.add(body->getWorldTransform().getBasis()[i]);
    }
    result.add(body->getLinearVelocity());
    result.add(body->getAngularVelocity());
    result.numbers.push_back(static_cast<btScalar>(body->getActivationState()));
  }
  for (int i = 0; i < scene.dispatcher().getNumManifolds(); ++i) {
    const btPersistentManifold* manifold = scene.dispatcher().getManifoldByIndexInternal(i);
    for (int k = 0; k < manifold->getNumContacts(); ++k) {
      const btManifoldPoint& point = manifold->getContactPoint(k);
      result.add(point.m_localPointA);
      result.add(point.m_localPointB);
      result.numbers.push_back(point.m_appliedImpulse);
      result.numbers.push_back(point.m_appliedImpulseLateral1);
      result.numbers.push_back(point.m_distance1);
    }
  }
  return result;
}

/// A heap of boxes, hulls, cylinders and capsules, thrown down at random.
void fill(BulletWorld& scene, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto u = [&] { return static_cast<btScalar>(uniform(random)); };
  auto* floor = scene.shape<btBoxShape>(btVector3(20, 1, 20));
  scene.body(floor, 0, btVector3(0, -1, 0));
  auto* box = scene.shape<btBoxShape>(btVector3(btScalar(0.4), btScalar(0.3), btScalar(0.5)));
  box->setMargin(0);
  auto* hull = box_hull(scene, btVector3(btScalar(0.3), btScalar(0.3), btScalar(0.3)), btScalar(0.01));
  auto* cylinder = scene.shape<btCylinderShape>(btVector3(btScalar(0.3), btScalar(0.4), btScalar(0.3)));
  auto* capsule = scene.shape<btCapsuleShape>(btScalar(0.2), btScalar(0.6));
  btCollisionShape* kinds[] = {box, hull, cylinder, capsule};
  for (int i = 0; i < 15; ++i) {
    btQuaternion turn{u(), u(), u(), u()};
    turn.normalize();
    btRigidBody* body = scene.body(kinds[i % 4], 1, btTransform(turn, btVector3{u(), btScalar(1 + 0.45 * i), u()}));
    body->setLinearVelocity(btVector3{u(), -2, u()});
    body->setAngularVelocity(btVector3{3 * u(), 3 * u(), 3 * u()});
  }
}

class Replay : public ::testing::TestWithParam<Contacts> {};

TEST_P(Replay, BitForBit) {
  for (const int save_at : {0, 20, 60, 110}) {
    for (const int length : {1, 2, 7, 40}) {
      BulletPenetrationDepthSolver solver;
      BulletWorld scene;
      BulletPenetrationDepthSolver* installed = nullptr;
      if (GetParam() != Contacts::bullet) {
        install(scene.world(), solver,
                GetParam() == Contacts::one_shot ? BulletContacts::one_shot : BulletContacts::persistent);
        installed = &solver;
      }
      scene.world().getSolverInfo().m_solverMode |= SOLVER_RANDMIZE_ORDER;
      fill(scene, 3);
      const btScalar h = btScalar(1.0 / 60);
      for (int i = 0; i < save_at; ++i) {
        scene.world().stepSimulation(h, 0);
      }
      const BulletSnapshot snapshot(scene.world(), installed);
      const auto run = [&] {
        for (int i = 0; i < length; ++i) {
          scene.world().stepSimulation(h, 0);
        }
        return record(scene);
      };
      const Record first = run();
      for (int replay = 0; replay < 2; ++replay) {
        ASSERT_EQ(snapshot.restore(), Restored::yes);
        const Record again = run();
        ASSERT_EQ(again.numbers.size(), first.numbers.size()) << save_at << "+" << length;
        EXPECT_EQ(std::memcmp(again.numbers.data(), first.numbers.data(), sizeof(btScalar) * first.numbers.size()), 0)
            << save_at << "+" << length << " replay " << replay;
      }
    }
  }
}

TEST_P(Replay, AStepOfAnotherLengthInBetweenLeavesNoTrace) {
  BulletPenetrationDepthSolver solver;
  BulletWorld scene;
  BulletPenetrationDepthSolver* installed = nullptr;
  if (GetParam() != Contacts::bullet) {
    install(scene.world(), solver,
            GetParam() == Contacts::one_shot ? BulletContacts::one_shot : BulletContacts::persistent);
    installed = &solver;
  }
  fill(scene, 5);
  const btScalar h = btScalar(1.0 / 60);
  for (int i = 0; i < 50; ++i) {
    scene.world().stepSimulation(h, 0);
  }
  const BulletSnapshot snapshot(scene.world(), installed);
  scene.world().stepSimulation(h, 0);
  const Record plain = record(scene);
  for (const double share : {0.9, 0.37, 0.01}) {
    ASSERT_EQ(snapshot.restore(), Restored::yes);
    scene.world().stepSimulation(static_cast<btScalar>(share) * h, 0);
    ASSERT_EQ(snapshot.restore(), Restored::yes);
    scene.world().stepSimulation(h, 0);
    EXPECT_EQ(record(scene).numbers, plain.numbers) << share;
  }
}

TEST(Snapshot, ForcesComeBackThroughTheFactors) {
  BulletWorld scene;
  auto* sphere = scene.shape<btSphereShape>(btScalar(1));
  btRigidBody* body = scene.body(sphere, 1, btVector3(0, 0, 0));
  body->setLinearFactor(btVector3(btScalar(0.5), 1, 0));
  body->setAngularFactor(btVector3(1, btScalar(0.25), 1));
  body->applyCentralForce(btVector3(4, 5, 6));
  body->applyTorque(btVector3(1, 2, 3));
  const btVector3 force = body->getTotalForce();
  const btVector3 torque = body->getTotalTorque();
  const BulletSnapshot snapshot(scene.world(), nullptr);
  body->clearForces();
  body->applyCentralForce(btVector3(9, 9, 9));
  ASSERT_EQ(snapshot.restore(), Restored::yes);
  EXPECT_EQ(body->getTotalForce(), force);
  EXPECT_EQ(body->getTotalTorque(), torque);
  EXPECT_EQ(body->getLinearFactor(), btVector3(btScalar(0.5), 1, 0));
}

INSTANTIATE_TEST_SUITE_P(AllContacts, Replay,
                         ::testing::Values(Contacts::bullet, Contacts::persistent, Contacts::one_shot));

/// A world with other bodies or joints than the saved one is left as it is, and the refusal says why.
TEST(BulletSnapshot, RefusesAWorldWithOtherBodiesOrJoints) {
  BulletPenetrationDepthSolver solver;
  BulletWorld scene;
  install(scene.world(), solver);
  fill(scene, 3);
  const auto step = [&] { scene.world().stepSimulation(btScalar(1) / 60, 0); };
  for (int i = 0; i < 30; ++i) step();
  const BulletSnapshot saved(scene.world(), &solver);
  btRigidBody& last = *scene.bodies().back();
  const auto stays = [&](Restored refusal) {
    step();
    const Record before = record(scene);
    EXPECT_EQ(saved.restore(), refusal) << message_of(saved.restore());
    EXPECT_EQ(before.numbers, record(scene).numbers);
    step();
  };
  scene.world().removeRigidBody(&last);
  stays(Restored::objects_differ);
  // Taken out and put back: its proxy is another one.
  scene.world().addRigidBody(&last);
  stays(Restored::objects_differ);
  const BulletSnapshot again(scene.world(), &solver);
  {
    btRigidBody added(1, nullptr, last.getCollisionShape(), btVector3(1, 1, 1));
    added.setWorldTransform(btTransform(btQuaternion::getIdentity(), btVector3(0, 30, 0)));
    scene.world().addRigidBody(&added);
    EXPECT_EQ(again.restore(), Restored::objects_differ);
    scene.world().removeRigidBody(&added);
  }
  EXPECT_EQ(again.restore(), Restored::yes);
  {
    btPoint2PointConstraint joint(last, btVector3(0, 0, 0));
    scene.world().addConstraint(&joint);
    EXPECT_EQ(again.restore(), Restored::joints_differ);
    scene.world().removeConstraint(&joint);
  }
  EXPECT_EQ(again.restore(), Restored::yes);
}

/// The sorted broadphase numbers the new body like the one that it replaces, and both lie at one address.
TEST(BulletSnapshot, TellsABodyFromTheNextOneInItsPlace) {
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btAxisSweep3 broadphase(btVector3(-10, -10, -10), btVector3(10, 10, 10));
  btSequentialImpulseConstraintSolver impulses;
  btDiscreteDynamicsWorld world(&dispatcher, &broadphase, &impulses, &configuration);
  btSphereShape ball(1);
  const btRigidBody::btRigidBodyConstructionInfo info(1, nullptr, &ball, btVector3(1, 1, 1));
  std::optional<btRigidBody> body(std::in_place, info);
  world.addRigidBody(&*body);
  const BulletSnapshot saved(world, nullptr);
  world.removeRigidBody(&*body);
  world.addRigidBody(&*body);
  EXPECT_EQ(saved.restore(), Restored::yes) << "the same body, taken out and put back";
  const int number = body->getBroadphaseHandle()->getUid();
  world.removeRigidBody(&*body);
  body.emplace(info);
  world.addRigidBody(&*body);
  ASSERT_EQ(body->getBroadphaseHandle()->getUid(), number);
  EXPECT_EQ(saved.restore(), Restored::objects_differ);
  world.removeRigidBody(&*body);
}

/// What a snapshot saved of the pairs is there although the solver is gone.
TEST(BulletSnapshot, MayBeRestoredAfterTheSolver) {
  auto solver = std::make_unique<BulletPenetrationDepthSolver>();
  BulletWorld scene;
  install(scene.world(), *solver);
  fill(scene, 4);
  for (int i = 0; i < 60; ++i) scene.world().stepSimulation(btScalar(1) / 60, 0);
  const BulletSnapshot saved(scene.world(), solver.get());
  const Record before = record(scene);
  for (int i = 0; i < 10; ++i) scene.world().stepSimulation(btScalar(1) / 60, 0);
  solver.reset();
  ASSERT_EQ(saved.restore(), Restored::yes);
  EXPECT_EQ(before.numbers, record(scene).numbers);
}

}  // namespace
}  // namespace pd::test
