// Bad input at the seam: no crash, no hang, and neighbours that do not notice.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "engine_glue/bullet_world.hpp"
#include "pd/bullet/install.hpp"
#include "pd/bullet/pair_answer.hpp"
#include "pd/bullet/shape_cache.hpp"
#include "scenes/bullet/bullet_scene.hpp"
#include "scenes/contact_worlds.hpp"

namespace pd::test {
namespace {

constexpr btScalar kStep = btScalar(1.0 / 60);
constexpr btScalar kNan = std::numeric_limits<btScalar>::quiet_NaN();

/// A box that rests on a floor among guests: whatever they are, it has to go on resting.
class Neighbour : public ::testing::Test {
 protected:
  Neighbour() : solver(quiet()) {
    install(scene.world(), solver);
    floor = scene.body(scene.shape<btBoxShape>(btVector3(20, 1, 20)), 0, btVector3(0, -1, 0));
    box = scene.body(scene.shape<btBoxShape>(btVector3(1, 1, 1)), 1, btVector3(0, 1, 0));
  }
  BulletSolverSettings quiet() {
    BulletSolverSettings settings;
    settings.warning = [](const char* line, void* user) { static_cast<Neighbour*>(user)->warnings.emplace_back(line); };
    settings.user = this;
    return settings;
  }
  void expect_rest(int steps = 60) {
    for (int i = 0; i < steps; ++i) {
      scene.world().stepSimulation(kStep, 0);
    }
    const btVector3 place = box->getWorldTransform().getOrigin();
    EXPECT_NEAR(static_cast<double>(place.x()), 0, 1e-3);
    EXPECT_NEAR(static_cast<double>(place.y()), 1, 1e-2);
  }

  std::vector<std::string> warnings;
  BulletPenetrationDepthSolver solver;
  BulletWorld scene;
  btRigidBody* floor;
  btRigidBody* box;
};

TEST_F(Neighbour, OfHullsThatAreNoBodies) {
  auto* empty = scene.shape<btConvexHullShape>();
  auto* point = scene.shape<btConvexHullShape>();
  point->addPoint(btVector3(0, 0, 0));
  auto* flat = scene.shape<btConvexHullShape>();
  for (int i = 0; i < 4; ++i) {
    flat->addPoint(btVector3((i & 1) ? 1 : -1, 0, (i & 2) ? 1 : -1));
  }
  auto* doubled = scene.shape<btConvexHullShape>();
  for (int i = 0; i < 8; ++i) {
    doubled->addPoint(btVector3(1, 1, 1));
  }
  btScalar x = 4;
  for (btConvexShape* shape : {empty, point, flat, doubled}) {
    scene.body(shape, 0, btVector3(x, btScalar(0.5), 0));
    x += 4;
  }
  expect_rest();
}

TEST_F(Neighbour, OfHullsOfNoNumbers) {
  auto* hull = scene.shape<btConvexHullShape>();
  for (int i = 0; i < 8; ++i) {
    hull->addPoint(btVector3((i & 1) ? 1 : -1, (i & 2) ? 1 : kNan, (i & 4) ? 1 : -1), false);
  }
  // Bullet's broadphase keeps bodies without finite boxes out of pairs; a contact test does not.
  btConvexHullShape& broken = *hull;
  const btTransform here(btQuaternion::getIdentity(), btVector3(0, 1, 0));
  EXPECT_FALSE(solver.query(broken, here, *static_cast<btConvexShape*>(box->getCollisionShape()), here).has_value());
  struct Count : btCollisionWorld::ContactResultCallback {
    int points = 0;
    btScalar addSingleResult(btManifoldPoint&, const btCollisionObjectWrapper*, int, int,
                             const btCollisionObjectWrapper*, int, int) override {
      ++points;
      return 0;
    }
  } count;
  btCollisionObject object;
  object.setCollisionShape(&broken);
  object.setWorldTransform(here);
  scene.world().contactPairTest(&object, box, count);
  EXPECT_EQ(count.points, 0);
  expect_rest();
}

TEST_F(Neighbour, OfPosesOfNoNumbers) {
  btRigidBody* lost = scene.body(scene.shape<btBoxShape>(btVector3(1, 1, 1)), 1, btVector3(4, 1, 0));
  expect_rest(5);
  lost->setLinearVelocity(btVector3(kNan, 0, 0));
  expect_rest();
}

TEST_F(Neighbour, OfShapesWithoutSize) {
  btScalar x = 4;
  for (btConvexShape* shape : {static_cast<btConvexShape*>(scene.shape<btBoxShape>(btVector3(0, 0, 0))),
                               static_cast<btConvexShape*>(scene.shape<btSphereShape>(btScalar(0))),
                               static_cast<btConvexShape*>(scene.shape<btCapsuleShape>(btScalar(0), btScalar(0))),
                               static_cast<btConvexShape*>(scene.shape<btCylinderShape>(btVector3(0, 0, 0))),
                               static_cast<btConvexShape*>(scene.shape<btConeShape>(btScalar(0), btScalar(0)))}) {
    scene.body(shape, 0, btVector3(x, btScalar(-0.01), 0));
    x += 3;
  }
  expect_rest();
}

TEST_F(Neighbour, FarFromTheOrigin) {
  const btScalar far = btScalar(1e6);
  scene.body(scene.shape<btBoxShape>(btVector3(20, 2, 20)), 0, btVector3(far, -2, far));
  btRigidBody* there = scene.body(scene.shape<btBoxShape>(btVector3(2, 2, 2)), 1, btVector3(far, 2, far));
  expect_rest(120);
  EXPECT_NEAR(static_cast<double>(there->getWorldTransform().getOrigin().y()), 2, 0.1);
}

TEST_F(Neighbour, OfHullsThatAreEditedAndDeleted) {
  expect_rest(10);
  auto* hull = box_hull(scene, btVector3(1, 1, 1), 0);
  btRigidBody* body = scene.body(hull, 1, btVector3(5, 1, 0));
  expect_rest(30);
  // In place, so that neither count nor address tell: noticed at the next step.
  for (int i = 0; i < hull->getNumPoints(); ++i) {
    hull->getUnscaledPoints()[i].setY(hull->getUnscaledPoints()[i].y() * 2);
  }
  hull->recalcLocalAabb();
  body->setWorldTransform(btTransform(btQuaternion::getIdentity(), btVector3(5, btScalar(1.9), 0)));
  scene.world().stepSimulation(kStep, 0);
  EXPECT_NEAR(scene.least_distance(), -0.1, 0.01);
  expect_rest(60);
  EXPECT_NEAR(static_cast<double>(body->getWorldTransform().getOrigin().y()), 2, 0.05);
  // Another shape at the address of one that died.
  scene.world().removeRigidBody(body);
  hull->~btConvexHullShape();
  new (hull) btConvexHullShape();
  for (int i = 0; i < 8; ++i) {
    hull->addPoint(btVector3((i & 1) ? 1 : -1, (i & 2) ? 3 : -3, (i & 4) ? 1 : -1), false);
  }
  hull->setMargin(0);
  hull->recalcLocalAabb();
  body->setWorldTransform(btTransform(btQuaternion::getIdentity(), btVector3(5, 3, 0)));
  body->setLinearVelocity(btVector3(0, 0, 0));
  scene.world().addRigidBody(body);
  expect_rest(30);
  EXPECT_NEAR(static_cast<double>(body->getWorldTransform().getOrigin().y()), 3, 0.05);
}

TEST(BadInput, TwentyBodiesAtOnePlaceComeApartAboveTheFloor) {
  for (const scenes::ContactRun run : {scenes::ContactRun::pdepth, scenes::ContactRun::pdepth_hulls}) {
    scenes::BulletScene scene(scenes::contact_scene("one-place").world, run);
    for (int i = 0; i < 300; ++i) {
      scene.step(60);
    }
    for (int i = 1; i < scene.num_bodies(); ++i) {
      const btVector3 place = scene.body(i).getWorldTransform().getOrigin();
      EXPECT_GT(static_cast<double>(place.z()), 0.3) << i;
      EXPECT_LT(static_cast<double>(place.length()), 30) << i;
    }
  }
}

}  // namespace
}  // namespace pd::test
