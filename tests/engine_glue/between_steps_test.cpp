// Between two steps a host detects contacts as often as it likes, edits shapes meanwhile, and exchanges solvers.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>

#include "bullet_world.hpp"
#include "pd/bullet/install.hpp"
#include "pd/bullet/rollback.hpp"

namespace pd::test {
namespace {

btTransform at(double x, double y, double z) {
  const btVector3 origin(static_cast<btScalar>(x), static_cast<btScalar>(y), static_cast<btScalar>(z));
  return btTransform(btQuaternion::getIdentity(), origin);
}

enum class Ground { box, plane, mesh };

/// A floor whose top is at y = 0, and no gravity.
struct Floor {
  explicit Floor(Ground ground, BulletContacts contacts = BulletContacts::one_shot) {
    w.world().setGravity(btVector3(0, 0, 0));
    EXPECT_TRUE(install(w.world(), solver, contacts));
    switch (ground) {
      case Ground::box:
        w.body(w.shape<btBoxShape>(btVector3(5, 1, 5)), 0, btVector3(0, -1, 0));
        break;
      case Ground::plane:
        w.body(w.shape<btStaticPlaneShape>(btVector3(0, 1, 0), btScalar(0)), 0, btVector3(0, 0, 0));
        break;
      case Ground::mesh: {
        const btVector3 a(-5, 0, -5), b(-5, 0, 5), c(5, 0, -5), d(5, 0, 5);
        triangles.addTriangle(a, b, c);
        triangles.addTriangle(c, b, d);
        auto* mesh = w.shape<btBvhTriangleMeshShape>(&triangles, true);
        mesh->setMargin(0);
        w.body(mesh, 0, btVector3(0, 0, 0));
        break;
      }
    }
  }
  btConvexHullShape* cube() {
    auto* hull = w.shape<btConvexHullShape>();
    for (int i = 0; i < 8; ++i) {
      hull->addPoint(btVector3(i & 1 ? btScalar(0.5) : btScalar(-0.5), i & 2 ? btScalar(0.5) : btScalar(-0.5),
                               i & 4 ? btScalar(0.5) : btScalar(-0.5)));
    }
    hull->setMargin(0);
    return hull;
  }

  btTriangleMesh triangles;
  BulletPenetrationDepthSolver solver;
  BulletWorld w;
};

/// One step, then a detection after each of three edits in place.
void expect_edits_are_noticed(Floor& floor, btConvexHullShape& hull, btCollisionShape& shape) {
  btRigidBody& body = *floor.w.body(&shape, 1, at(0, 0.5, 0));
  floor.w.world().stepSimulation(btScalar(1) / 60, 0);
  double half = 0.5;
  for (int round = 0; round < 3; ++round) {
    half *= 1.1;
    for (int i = 0; i < 8; ++i) hull.getUnscaledPoints()[i] *= btScalar(1.1);
    hull.recalcLocalAabb();
    if (shape.isCompound()) static_cast<btCompoundShape&>(shape).recalculateLocalAabb();
    body.setWorldTransform(at(0, 0.5, 0));
    floor.w.world().performDiscreteCollisionDetection();
    EXPECT_NEAR(floor.w.least_distance(), 0.5 - half, 1e-5) << round;
  }
}

TEST(BetweenSteps, EditsOfPointsAreNoticedByEachDetection) {
  for (const Ground ground : {Ground::box, Ground::plane, Ground::mesh}) {
    SCOPED_TRACE(static_cast<int>(ground));
    Floor alone(ground);
    btConvexHullShape& hull = *alone.cube();
    expect_edits_are_noticed(alone, hull, hull);
    Floor child(ground);
    btConvexHullShape& part = *child.cube();
    auto* compound = child.w.shape<btCompoundShape>();
    compound->addChildShape(btTransform::getIdentity(), &part);
    expect_edits_are_noticed(child, part, *compound);
  }
  Floor persistent(Ground::box, BulletContacts::persistent);
  btConvexHullShape& hull = *persistent.cube();
  expect_edits_are_noticed(persistent, hull, hull);
}

/// A compound in a compound.
struct Nested {
  explicit Nested(Floor& floor) {
    inner = floor.w.shape<btCompoundShape>();
    outer = floor.w.shape<btCompoundShape>();
    auto* cube = floor.w.shape<btBoxShape>(btVector3(btScalar(0.5), btScalar(0.5), btScalar(0.5)));
    inner->addChildShape(at(0, 0, 0), cube);
    outer->addChildShape(at(0, 0, 0), inner);
  }
  btCompoundShape* inner;
  btCompoundShape* outer;
};

TEST(BetweenSteps, ChildrenOfChildrenMayMove) {
  for (const Ground ground : {Ground::box, Ground::plane, Ground::mesh}) {
    Floor floor(ground);
    const Nested nested(floor);
    btRigidBody& body = *floor.w.body(nested.outer, 1, at(0, 0.5, 0));
    floor.w.world().stepSimulation(btScalar(1) / 60, 0);
    floor.w.world().performDiscreteCollisionDetection();
    for (int round = 1; round <= 3; ++round) {
      nested.inner->updateChildTransform(0, at(0, -0.05 * round, 0));
      nested.outer->recalculateLocalAabb();
      body.setWorldTransform(at(0, 0.5, 0));
      floor.w.world().performDiscreteCollisionDetection();
      EXPECT_NEAR(floor.w.least_distance(), -0.05 * round, 1e-5) << static_cast<int>(ground);
    }
  }
}

/// A child that tells when it is read after its end.
class Mortal : public btBoxShape {
 public:
  using btBoxShape::btBoxShape;
  void getAabb(const btTransform& pose, btVector3& lower, btVector3& upper) const override {
    if (dead) ++read_dead;
    btBoxShape::getAabb(pose, lower, upper);
  }
  bool dead = false;
  mutable int read_dead = 0;
};

/// Takes the child out, and detects, within the step in which the child was met.
struct Remover : btActionInterface {
  explicit Remover(Nested& of, Mortal& child) : nested(of), mortal(child) {}
  void updateAction(btCollisionWorld* world, btScalar) override {
    nested.inner->removeChildShape(&mortal);
    mortal.dead = true;
    nested.outer->recalculateLocalAabb();
    world->performDiscreteCollisionDetection();
  }
  void debugDraw(btIDebugDraw*) override {}
  Nested& nested;
  Mortal& mortal;
};

TEST(BetweenSteps, AChildThatIsGoneIsNotRead) {
  for (const bool within_step : {false, true}) {
    for (const Ground ground : {Ground::box, Ground::plane, Ground::mesh}) {
      Floor floor(ground);
      Nested nested(floor);
      auto* mortal = floor.w.shape<Mortal>(btVector3(btScalar(0.5), btScalar(0.5), btScalar(0.5)));
      nested.inner->addChildShape(at(0, 0.1, 0), mortal);
      nested.outer->recalculateLocalAabb();
      floor.w.body(nested.outer, 1, at(0, 0.5, 0));
      Remover remover(nested, *mortal);
      if (within_step) {
        // The host's action comes before the solver's, which ends the step.
        ASSERT_TRUE(uninstall(floor.w.world(), floor.solver));
        floor.w.world().addAction(&remover);
        ASSERT_TRUE(install(floor.w.world(), floor.solver));
      }
      floor.w.world().stepSimulation(btScalar(1) / 60, 0);
      floor.w.world().performDiscreteCollisionDetection();
      if (!within_step) remover.updateAction(&floor.w.world(), 0);
      EXPECT_TRUE(mortal->dead);
      EXPECT_EQ(mortal->read_dead, 0) << static_cast<int>(ground) << within_step;
      EXPECT_GT(floor.w.num_contacts(), 0);
      floor.w.world().removeAction(&remover);
    }
  }
}

TEST(BetweenSteps, OnlyTheInstalledSolverIsUninstalled) {
  BulletWorld w;
  BulletPenetrationDepthSolver first, second;
  auto* cube = w.shape<btBoxShape>(btVector3(1, 1, 1));
  w.body(cube, 0, btVector3(0, 0, 0));
  w.body(cube, 1, btVector3(0, btScalar(1.99), 0))->setActivationState(DISABLE_DEACTIVATION);
  const auto calls_of_a_step = [&](BulletPenetrationDepthSolver& solver) {
    solver.reset_statistics();
    w.world().stepSimulation(btScalar(1) / 240, 0);
    return solver.statistics().calls;
  };
  ASSERT_TRUE(install(w.world(), first));
  EXPECT_FALSE(uninstall(w.world(), second));
  ASSERT_TRUE(install(w.world(), second));
  EXPECT_FALSE(uninstall(w.world(), first));
  EXPECT_TRUE(uninstall(w.world(), second));
  EXPECT_FALSE(uninstall(w.world(), second));
  auto* hull = w.shape<btConvexHullShape>();
  hull->addPoint(btVector3(0, 0, 0));
  hull->setMargin(btScalar(0.5));
  w.body(hull, 0, btVector3(0, 0, btScalar(1.49)));
  ASSERT_TRUE(install(w.world(), first));
  ASSERT_TRUE(install(w.world(), second));
  EXPECT_FALSE(uninstall(w.world(), first));
  EXPECT_EQ(calls_of_a_step(first), 0);
  // A dispatcher without a world that steps.
  install(w.dispatcher(), first);
  EXPECT_FALSE(uninstall(w.world(), second));
  EXPECT_TRUE(uninstall(w.world(), first));
}

TEST(BetweenSteps, AStepWithoutFixedPartsIsTheTimeItself) {
  const auto height_after_a_second = [](bool rollback) {
    BulletWorld w;
    BulletPenetrationDepthSolver solver;
    install(w.world(), solver);
    btRigidBody* ball = w.body(w.shape<btSphereShape>(btScalar(0.5)), 1, btVector3(0, 3, 0));
    RollbackSettings settings;
    settings.exact_flight = false;
    RollbackStepper stepper(w.world(), solver, settings);
    for (int i = 0; i < 60; ++i) {
      if (rollback) {
        EXPECT_EQ(stepper.step(btScalar(1) / 60, 0, btScalar(1) / 60).parts, 1);
      } else {
        w.world().stepSimulation(btScalar(1) / 60, 0, btScalar(1) / 60);
      }
    }
    return ball->getWorldTransform().getOrigin().y();
  };
  EXPECT_EQ(height_after_a_second(true), height_after_a_second(false));
  EXPECT_LT(height_after_a_second(true), 0);
}

}  // namespace
}  // namespace pd::test
