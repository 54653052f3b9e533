// Points that the solver cannot need cost a multibody ten times a rigid body's row, and a falling block half of its
// step.
#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "bullet_world.hpp"
#include "pd/bullet/install.hpp"

namespace pd::test {
namespace {

int points_of(btDispatcher& dispatcher) {
  int count = 0;
  for (int i = 0; i < dispatcher.getNumManifolds(); ++i) {
    count += dispatcher.getManifoldByIndexInternal(i)->getNumContacts();
  }
  return count;
}

/// 5 x 5 x 5 boxes that touch, let go two metres above a floor.
struct Block {
  explicit Block(bool ours) {
    if (ours) install(w.world(), solver);
    w.body(w.shape<btBoxShape>(btVector3(50, 50, 50)), 0, btVector3(0, -50, 0));
    auto* box = w.shape<btBoxShape>(btVector3(btScalar(0.1), btScalar(0.1), btScalar(0.1)));
    for (int k = 0; k < 5; ++k) {
      for (int i = 0; i < 5; ++i) {
        for (int j = 0; j < 5; ++j) {
          const btVector3 at(static_cast<btScalar>(0.2 * i), static_cast<btScalar>(2 + 0.2 * k),
                             static_cast<btScalar>(0.2 * j));
          w.body(box, 1, at)->setActivationState(DISABLE_DEACTIVATION);
        }
      }
    }
  }
  void step(int count) {
    for (int i = 0; i < count; ++i) w.world().stepSimulation(btScalar(1) / 60, 0);
  }
  BulletPenetrationDepthSolver solver;
  BulletWorld w;
};

TEST(IdlePoints, ABlockThatFallsHasNoMoreThanBullets) {
  Block ours(true), bullets(false);
  ours.step(20);
  bullets.step(20);
  EXPECT_LE(points_of(ours.w.dispatcher()), 1.1 * points_of(bullets.w.dispatcher()));
  const auto deepest_after_landing = [](Block& block) {
    block.step(100);
    double deepest = 0;
    for (int i = 0; i < 60; ++i) {
      block.step(1);
      deepest = std::max(deepest, -block.w.least_distance());
    }
    return deepest;
  };
  EXPECT_LE(deepest_after_landing(ours), deepest_after_landing(bullets));
}

enum class Surface { plane, box, mesh, compound };

/// A cube of a metre over a surface, as the base of a multibody.
struct HoveringLink {
  HoveringLink(Surface surface, btScalar gap, btScalar speed) {
    install(world, solver);
    world.setGravity(btVector3(0, -10, 0));
    const auto p = [](int x, int z) { return btVector3(static_cast<btScalar>(x), 0, static_cast<btScalar>(z)); };
    triangles.addTriangle(p(-5, -5), p(-5, 5), p(5, -5));
    triangles.addTriangle(p(5, -5), p(-5, 5), p(5, 5));
    btTransform low(btQuaternion::getIdentity(), btVector3(0, -1, 0));
    switch (surface) {
      case Surface::plane:
        ground = std::make_unique<btStaticPlaneShape>(btVector3(0, 1, 0), btScalar(0));
        low.setIdentity();
        break;
      case Surface::box:
        ground = std::make_unique<btBoxShape>(btVector3(5, 1, 5));
        break;
      case Surface::mesh:
        ground = std::make_unique<btBvhTriangleMeshShape>(&triangles, true);
        ground->setMargin(0);
        low.setIdentity();
        break;
      case Surface::compound: {
        auto compound = std::make_unique<btCompoundShape>();
        compound->addChildShape(btTransform(btQuaternion::getIdentity(), btVector3(-2, 0, 0)), &half);
        compound->addChildShape(btTransform(btQuaternion::getIdentity(), btVector3(2, 0, 0)), &half);
        ground = std::move(compound);
        break;
      }
    }
    floor.setCollisionShape(ground.get());
    floor.setWorldTransform(low);
    world.addCollisionObject(&floor, 1, 2);
    body.finalizeMultiDof();
    body.setBaseWorldTransform(btTransform(btQuaternion::getIdentity(), btVector3(0, btScalar(0.5) + gap, 0)));
    body.setBaseVel(btVector3(0, speed, 0));
    body.setCanSleep(false);
    collider.setCollisionShape(&cube);
    collider.setWorldTransform(body.getBaseWorldTransform());
    body.setBaseCollider(&collider);
    world.addCollisionObject(&collider, 2, 1);
    world.addMultiBody(&body);
  }
  ~HoveringLink() {
    world.removeMultiBody(&body);
    world.removeCollisionObject(&collider);
    world.removeCollisionObject(&floor);
  }
  void step(int count) {
    for (int i = 0; i < count; ++i) world.stepSimulation(btScalar(1) / 240, 0);
  }

  BulletPenetrationDepthSolver solver;
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btMultiBodyConstraintSolver rows;
  btMultiBodyDynamicsWorld world{&dispatcher, &broadphase, &rows, &configuration};
  btTriangleMesh triangles;
  btBoxShape half{btVector3(2, 1, 5)};
  btBoxShape cube{btVector3(btScalar(0.5), btScalar(0.5), btScalar(0.5))};
  std::unique_ptr<btCollisionShape> ground;
  btCollisionObject floor;
  btMultiBody body{0, 1, btVector3(1, 1, 1), false, false};
  btMultiBodyLinkCollider collider{&body, -1};
};

class IdleLink : public testing::TestWithParam<Surface> {};

TEST_P(IdleLink, HasPointsWhereItMayTouchInTheStep) {
  HoveringLink idle(GetParam(), btScalar(0.004), 0);
  idle.step(1);
  EXPECT_EQ(points_of(idle.dispatcher), 0);
  HoveringLink coming(GetParam(), btScalar(0.004), -1);
  coming.step(1);
  EXPECT_EQ(points_of(coming.dispatcher), 4);
  HoveringLink falling(GetParam(), btScalar(0.004), 0);
  double deepest = 0;
  for (int i = 0; i < 120; ++i) {
    falling.step(1);
    deepest = std::max(deepest, 0.5 - static_cast<double>(falling.body.getBasePos().y()));
  }
  EXPECT_LT(deepest, 1e-4);
  EXPECT_EQ(points_of(falling.dispatcher), 4) << "it rests";
}

std::string surface_name(const testing::TestParamInfo<Surface>& instance) {
  constexpr const char* kNames[] = {"Plane", "Box", "Mesh", "Compound"};
  return kNames[static_cast<int>(instance.param)];
}

INSTANTIATE_TEST_SUITE_P(Surfaces, IdleLink,
                         testing::Values(Surface::plane, Surface::box, Surface::mesh, Surface::compound), surface_name);

}  // namespace
}  // namespace pd::test
