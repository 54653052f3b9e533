// A thin body stays on the side of a mesh that it came from, and a sheet has two sides all the same.
#include <BulletCollision/CollisionShapes/btHeightfieldTerrainShape.h>
#include <btBulletDynamicsCommon.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <memory>
#include <random>

#include "engine_glue/bullet_world.hpp"
#include "pd/bullet/install.hpp"

namespace pd::test {
namespace {

enum class Sheet { two_triangles, cells, heightfield };

btVector3 at(double x, double y, double z) { return {btScalar(x), btScalar(y), btScalar(z)}; }

/// A sheet in the plane y = 0 and what moves over it.
class OverASheet {
 public:
  explicit OverASheet(Sheet sheet, double half = 6) {
    install(world_.world(), solver_);
    btCollisionShape* shape = nullptr;
    if (sheet == Sheet::heightfield) {
      shape = world_.shape<btHeightfieldTerrainShape>(33, 33, heights_.data(), btScalar(1), btScalar(-1), btScalar(1),
                                                      1, PHY_FLOAT, false);
      shape->setLocalScaling(at(0.5, 1, 0.5));
    } else {
      const double cell = sheet == Sheet::cells ? 0.5 : 2 * half;
      const int count = static_cast<int>(2 * half / cell);
      for (int i = 0; i < count; ++i) {
        for (int k = 0; k < count; ++k) {
          const double x = -half + i * cell, z = -half + k * cell;
          triangles_.addTriangle(at(x, 0, z), at(x, 0, z + cell), at(x + cell, 0, z + cell));
          triangles_.addTriangle(at(x, 0, z), at(x + cell, 0, z + cell), at(x + cell, 0, z));
        }
      }
      shape = world_.shape<btBvhTriangleMeshShape>(&triangles_, true);
    }
    shape->setMargin(btScalar(0.004));
    world_.body(shape, 0, at(0, 0, 0))->setFriction(btScalar(0.7));
  }

  /// A plate of 2 x 0.03 x 2 m, whose lowest corner is at a height.
  btRigidBody* plate(const btQuaternion& turn, double height) {
    const btVector3 half = at(1, 0.015, 1);
    const auto margin = btScalar(0.004);
    const btTransform turned(turn, at(0.3, 0, -0.2));
    const btVector3 reach = turned.getBasis().absolute() * half;
    btRigidBody* const body = world_.body(box_hull(world_, half - btVector3(margin, margin, margin), margin), 60,
                                          btTransform(turn, at(0.3, height + static_cast<double>(reach.y()), -0.2)));
    body->setFriction(btScalar(0.7));
    body->setActivationState(DISABLE_DEACTIVATION);
    return body;
  }
  /// A plate of that size, made of four boxes. One of them may be through the sheet as a whole and the others not.
  btRigidBody* plate_of_boxes(const btQuaternion& turn, double height) {
    auto* const whole = world_.shape<btCompoundShape>();
    auto* const box = world_.shape<btBoxShape>(at(0.5, 0.015, 0.5));
    for (const double x : {-0.5, 0.5}) {
      for (const double z : {-0.5, 0.5}) {
        whole->addChildShape(btTransform(btQuaternion::getIdentity(), at(x, 0, z)), box);
      }
    }
    const btVector3 reach = btTransform(turn).getBasis().absolute() * at(1, 0.015, 1);
    btRigidBody* const body =
        world_.body(whole, 60, btTransform(turn, at(0.3, height + static_cast<double>(reach.y()), -0.2)));
    body->setFriction(btScalar(0.7));
    body->setActivationState(DISABLE_DEACTIVATION);
    return body;
  }
  void step(int count, int rate = 60) {
    for (int i = 0; i < count; ++i) world_.world().stepSimulation(btScalar(1) / btScalar(rate), 0);
  }
  BulletWorld& world() { return world_; }

 private:
  BulletPenetrationDepthSolver solver_;
  std::array<btScalar, 33 * 33> heights_{};  // Bullet reads PHY_FLOAT in its own precision
  btTriangleMesh triangles_;
  BulletWorld world_;
};

btQuaternion any_turn(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> share(-1, 1);
  const auto next = [&] { return btScalar(share(random)); };
  btQuaternion turn{next(), next(), next(), next()};
  return turn.normalize();
}

double height_of(const btRigidBody& body) { return static_cast<double>(body.getWorldTransform().getOrigin().y()); }

TEST(ThinBody, DoesNotFallThroughAMesh) {
  for (const Sheet sheet : {Sheet::two_triangles, Sheet::cells, Sheet::heightfield}) {
    for (const double drop : {0.05, 1.0}) {
      int lost = 0;
      for (unsigned start = 0; start < 20; ++start) {
        OverASheet scene(sheet);
        const btRigidBody* const body = scene.plate(any_turn(start), drop);
        scene.step(240);
        lost += height_of(*body) < -0.2 ? 1 : 0;
      }
      EXPECT_EQ(lost, 0) << static_cast<int>(sheet) << ", dropped " << drop << " m";
    }
  }
}

/// A child that is through the sheet as a whole after one step is led back, too. One start in thirty still falls
/// edgewise between two of the cells.
TEST(ThinBody, OfSeveralPartsDoesNotFallThroughAMesh) {
  int lost = 0;
  for (const Sheet sheet : {Sheet::two_triangles, Sheet::cells, Sheet::heightfield}) {
    for (unsigned start = 0; start < 60; ++start) {
      OverASheet scene(sheet);
      const btRigidBody* const body = scene.plate_of_boxes(any_turn(start), 0.05);
      scene.step(120, 30);
      lost += height_of(*body) < -0.2 ? 1 : 0;
    }
  }
  EXPECT_LE(lost, 8) << "of 180";
}

/// A small ball leaps over the reach of contacts, and over itself, in one step.
TEST(ThinBody, ThatIsSmallDoesNotLeapThroughAMesh) {
  for (const Sheet sheet : {Sheet::two_triangles, Sheet::cells, Sheet::heightfield}) {
    OverASheet scene(sheet);
    btRigidBody* const ball =
        scene.world().body(scene.world().shape<btSphereShape>(btScalar(0.015)), 1, at(0.3, 0.065, -0.2));
    ball->setActivationState(DISABLE_DEACTIVATION);
    scene.step(60, 30);
    EXPECT_NEAR(height_of(*ball), 0.019, 0.005) << static_cast<int>(sheet);
  }
}

/// A rod that comes through by one end is near several triangles. A contact that leads off one of them over its edge is
/// not turned to its back, and a rod that is through as a whole is led back until it is out, however slow it is.
TEST(ThinBody, ThatIsLongDoesNotFallThroughAMesh) {
  std::array<int, 3> lost{};
  for (const Sheet sheet : {Sheet::two_triangles, Sheet::cells, Sheet::heightfield}) {
    for (unsigned start = 0; start < 60; ++start) {
      OverASheet scene(sheet);
      auto* const rod = scene.world().shape<btCapsuleShape>(btScalar(0.03), btScalar(0.6));
      const btRigidBody* const body =
          scene.world().body(rod, 1, btTransform(any_turn(start), at(0.3, 2 + 0.05 * start, -0.2)));
      scene.step(75, 30);
      lost[static_cast<std::size_t>(sheet)] += height_of(*body) < -0.5 ? 1 : 0;
    }
  }
  EXPECT_LE(lost[0] + lost[1] + lost[2], 70) << lost[0] << ", " << lost[1] << " and " << lost[2] << " of 60";
}

/// The side is where the body came from, and neither that of the triangles' corners nor up.
TEST(ThinBody, ComesFromBelowAsWell) {
  for (const Sheet sheet : {Sheet::two_triangles, Sheet::cells, Sheet::heightfield}) {
    OverASheet scene(sheet);
    scene.world().world().setGravity(at(0, 9.81, 0));
    const btRigidBody* const body = scene.plate(btQuaternion(at(1, 0, 0.3).normalized(), btScalar(0.2)), -1);
    scene.step(240);
    EXPECT_NEAR(height_of(*body), -0.019, 0.01) << static_cast<int>(sheet);
  }
}

/// What goes around the rim of a sheet is on its other side then.
TEST(ThinBody, GoesAroundARim) {
  OverASheet scene(Sheet::cells, 1);
  btRigidBody* const ball = scene.world().body(scene.world().shape<btSphereShape>(btScalar(0.1)), 1, at(0.8, 0.11, 0));
  ball->setActivationState(DISABLE_DEACTIVATION);
  scene.world().world().setGravity(at(0, 0, 0));
  ball->setGravity(at(0, 0, 0));
  // Over the rim, down, back below it, and up against the sheet.
  const auto move = [&](const btVector3& velocity, int steps) {
    for (int i = 0; i < steps; ++i) {
      ball->setLinearVelocity(velocity);
      scene.step(1);
    }
  };
  move(at(2, -0.1, 0), 16);
  move(at(0, -2, 0), 8);
  move(at(-2, 0, 0), 24);
  move(at(0, 0.5, 0), 60);
  EXPECT_NEAR(height_of(*ball), -0.104, 0.02);
  EXPECT_LT(static_cast<double>(ball->getWorldTransform().getOrigin().x()), 0.8);
}

/// A host may put a body to the other side.
TEST(ThinBody, StaysWhereTheHostPutsIt) {
  OverASheet scene(Sheet::cells);
  btRigidBody* const body = scene.plate(btQuaternion::getIdentity(), 0.01);
  scene.step(60);
  EXPECT_NEAR(height_of(*body), 0.019, 0.005);
  btTransform below = body->getWorldTransform();
  below.getOrigin().setY(btScalar(-0.2));
  body->setWorldTransform(below);
  body->setInterpolationWorldTransform(below);
  body->setLinearVelocity(at(0, 0, 0));
  scene.step(30);
  EXPECT_LT(height_of(*body), -0.5);
}

/// The deepest contact that pushes a capsule down, which falls into a valley between two slopes of a mesh.
double deepest_push_down(unsigned start) {
  std::mt19937 random(start);
  std::uniform_real_distribution<double> share(-1, 1);
  BulletPenetrationDepthSolver solver;
  btTriangleMesh triangles;
  BulletWorld world;
  install(world.world(), solver);
  const auto on_slopes = [](double x, double z) { return at(x, x > 0 ? 0.29 * x : 0.175 * x, z); };
  for (const double x : {-8.0, 0.0}) {
    triangles.addTriangle(on_slopes(x, -4), on_slopes(x, 4), on_slopes(x + 8, 4));
    triangles.addTriangle(on_slopes(x, -4), on_slopes(x + 8, 4), on_slopes(x + 8, -4));
  }
  btCollisionShape* const valley = world.shape<btBvhTriangleMeshShape>(&triangles, true);
  valley->setMargin(0);
  world.body(valley, 0, at(0, 0, 0));
  const double x = 0.4 + 0.4 * share(random);
  const double tilt = 0.5 * share(random);
  const double y = 4 + 0.25 * share(random);
  const double z = share(random);
  const btTransform pose(btQuaternion(at(0, 0, 1), btScalar(tilt)), at(x, y, z));
  btRigidBody* const capsule = world.body(world.shape<btCapsuleShape>(btScalar(1), btScalar(2)), 1, pose);
  const double along = share(random), across = share(random);
  capsule->setLinearVelocity(at(3 * along - 3, -28, across));
  double deepest = 0;
  btDispatcher& dispatcher = *world.world().getDispatcher();
  for (int i = 0; i < 60; ++i) {
    world.world().stepSimulation(btScalar(1) / 60, 0);
    for (int m = 0; m < dispatcher.getNumManifolds(); ++m) {
      const btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal(m);
      for (int k = 0; k < manifold.getNumContacts(); ++k) {
        const btManifoldPoint& point = manifold.getContactPoint(k);
        // Normals lead to the first body.
        const double up = static_cast<double>(point.m_normalWorldOnB.y()) * (manifold.getBody0() == capsule ? 1 : -1);
        if (up < 0) deepest = std::max(deepest, -static_cast<double>(point.getDistance()));
      }
    }
  }
  return deepest;
}

TEST(ThinBody, WhatIsPushedOutOfASlopeDidNotComeFromBelow) {
  for (unsigned start = 0; start < 200; ++start) {
    ASSERT_EQ(deepest_push_down(start), 0) << "start " << start;
  }
}

}  // namespace
}  // namespace pd::test
