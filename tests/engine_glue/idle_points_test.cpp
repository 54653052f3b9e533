// Points that the solver cannot need cost a multibody ten times a rigid body's row, and a falling block half of its
// step.
#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "bullet_world.hpp"
#include "pd/bullet/install.hpp"
#include "pd/bullet/snapshot.hpp"

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

/// Rounding decides which neighbours along an edge touch, and where the boxes lie after they have landed.
TEST(IdlePoints, ABlockThatFallsHasHardlyMoreThanBullets) {
  Block ours(true), bullets(false);
  ours.step(10);
  bullets.step(10);
  int points = 0, points_of_bullet = 0;
  for (int i = 0; i < 20; ++i) {
    ours.step(1);
    bullets.step(1);
    points += points_of(ours.w.dispatcher());
    points_of_bullet += points_of(bullets.w.dispatcher());
  }
  EXPECT_LE(points, 1.2 * points_of_bullet);
  const auto deepest_after_landing = [](Block& block) {
    block.step(90);
    double deepest = 0;
    for (int i = 0; i < 60; ++i) {
      block.step(1);
      deepest = std::max(deepest, -block.w.least_distance());
    }
    return deepest;
  };
  EXPECT_LE(deepest_after_landing(ours), 1.5 * deepest_after_landing(bullets));
}

/// The largest error of a contact of a block of unturned boxes: how far its two points are off their boxes, and how
/// much less its distance is than the gap of the boxes along its normal. 0 without contacts.
double worst_contact(btDispatcher& dispatcher) {
  const btScalar half = btScalar(0.1);
  const auto off_box = [&](const btVector3& point, const btVector3& centre) {
    const btVector3 off = (point - centre).absolute();
    return static_cast<double>(off[off.maxAxis()] - half);
  };
  double worst = 0;
  for (int i = 0; i < dispatcher.getNumManifolds(); ++i) {
    const btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal(i);
    const btVector3 a = manifold.getBody0()->getWorldTransform().getOrigin();
    const btVector3 b = manifold.getBody1()->getWorldTransform().getOrigin();
    for (int k = 0; k < manifold.getNumContacts(); ++k) {
      const btManifoldPoint& point = manifold.getContactPoint(k);
      const btVector3 n = point.m_normalWorldOnB;
      const btScalar gap = (a - b).dot(n) - 2 * half * n.absolute().dot(btVector3(1, 1, 1));
      worst = std::max({worst, off_box(point.m_positionWorldOnA, a), off_box(point.m_positionWorldOnB, b),
                        static_cast<double>(gap - point.getDistance())});
    }
  }
  return worst;
}

TEST(IdlePoints, ABlockThatFallsIsHardlyAsked) {
  Block block(true);
  block.step(10);  // faster than what has just been let go
  block.solver.reset_statistics();
  const std::int64_t pairs = block.w.dispatcher().getNumManifolds();
  for (int i = 0; i < 20; ++i) {
    block.step(1);
    block.w.world().performDiscreteCollisionDetection();
    ASSERT_GT(points_of(block.w.dispatcher()), 0);
    ASSERT_LT(worst_contact(block.w.dispatcher()), 2e-6) << "step " << i;
  }
  EXPECT_LT(block.solver.statistics().calls, 2 * 20 * pairs / 5);
}

/// The blow comes in the middle of the flight, while the boxes stand to each other as in the last question.
TEST(IdlePoints, ABlowInFlightIsSeenInItsStep) {
  Block block(true);
  block.step(20);
  btRigidBody& corner = *block.w.bodies().back();
  corner.setLinearVelocity(corner.getLinearVelocity() - btVector3(4, 0, 0));
  block.step(1);
  EXPECT_LT(static_cast<double>(corner.getLinearVelocity().x()), -0.5);
  EXPECT_GT(static_cast<double>(corner.getLinearVelocity().x()), -3.5) << "the row in its way takes its share";
  btScalar momentum = 0;
  for (const auto& body : block.w.bodies()) momentum += body->getInvMass() > 0 ? body->getLinearVelocity().x() : 0;
  EXPECT_NEAR(static_cast<double>(momentum), -4, 0.01);
}

TEST(IdlePoints, AReplayOfAFlightHasTheSameBits) {
  Block block(true);
  block.step(15);
  const BulletSnapshot saved(block.w.world(), &block.solver);
  const auto places = [&] {
    std::vector<btVector3> out;
    for (const auto& body : block.w.bodies()) out.push_back(body->getWorldTransform().getOrigin());
    return out;
  };
  block.step(30);  // beyond the landing
  const std::vector<btVector3> first = places();
  ASSERT_EQ(saved.restore(), Restored::yes);
  block.step(30);
  EXPECT_EQ(first, places());
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
  HoveringLink idle(GetParam(), btScalar(0.001), 0);
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

/// Bullet's sweeps over a multibody's rows, which begin at zero in every step, converge soon if they begin where most
/// of the load is.
TEST_P(IdleLink, BeginsWithThePointThatCarriedMostAndItsNeighbour) {
  HoveringLink link(GetParam(), btScalar(0.004), 0);
  link.body.setBaseOmega(btVector3(btScalar(0.3), 0, btScalar(0.2)));
  struct Load {
    btVector3 place;
    btScalar impulse;
  };
  std::vector<Load> before;
  int seen = 0, carried = 0;
  for (int i = 0; i < 120; ++i) {
    link.step(1);
    std::vector<Load> now;
    for (int k = 0; k < link.dispatcher.getNumManifolds(); ++k) {
      const btPersistentManifold& manifold = *link.dispatcher.getManifoldByIndexInternal(k);
      const auto place = [&](int j) { return manifold.getContactPoint(j).m_localPointA; };
      for (int j = 0; j < manifold.getNumContacts(); ++j) {
        now.push_back({place(j), manifold.getContactPoint(j).m_appliedImpulse});
      }
      if (manifold.getNumContacts() < 4) continue;
      ++seen;
      const auto gap = [&](int j) { return (place(j) - place(0)).length(); };
      EXPECT_LE(gap(1), btScalar(1.01) * std::min(gap(2), gap(3))) << i;
      EXPECT_GE(gap(2), btScalar(0.99) * gap(3)) << i;
      if (before.size() != 4) continue;
      const auto most = std::max_element(before.begin(), before.end(),
                                         [](const Load& x, const Load& y) { return x.impulse < y.impulse; });
      if (!(most->impulse > 0)) continue;
      ++carried;
      const auto first = std::min_element(before.begin(), before.end(), [&](const Load& x, const Load& y) {
        return x.place.distance2(place(0)) < y.place.distance2(place(0));
      });
      EXPECT_GE(first->impulse, btScalar(0.5) * most->impulse) << i << ", where the trend is followed";
    }
    before = now;
  }
  EXPECT_GT(seen, 60);
  EXPECT_GT(carried, 40);
}

/// Ten dominoes of 3 x 5 x 15 cm side by side on a table, each the base of a multibody, in a world as PyBullet sets it
/// up.
struct Dominoes {
  explicit Dominoes(bool ours) {
    if (ours) install(world, solver);
    world.setGravity(btVector3(0, 0, -10));
    btContactSolverInfo& info = world.getSolverInfo();
    info.m_numIterations = 50;
    info.m_leastSquaresResidualThreshold = btScalar(1e-7);
    info.m_minimumSolverBatchSize = 0;
    info.m_erp2 = btScalar(0.08);
    info.m_frictionERP = btScalar(0.2);
    info.m_linearSlop = btScalar(1e-5);
    info.m_warmstartingFactor = btScalar(0.1);
    info.m_reportSolverAnalytics = 1;
    table.setCollisionShape(&top);
    table.setWorldTransform(btTransform(btQuaternion::getIdentity(), btVector3(0, 0, -5)));
    world.addCollisionObject(&table, 2, 1);
    const btTransform place = btTransform::getIdentity();
    stone.addChildShape(place, &box);
    btVector3 inertia;
    stone.calculateLocalInertia(btScalar(0.05), inertia);
    for (int i = 0; i < 10; ++i) {
      auto& body = *bodies.emplace_back(std::make_unique<btMultiBody>(0, btScalar(0.05), inertia, false, false));
      body.finalizeMultiDof();
      const btVector3 at(0, btScalar(0.05) * static_cast<btScalar>(i), btScalar(0.075));
      body.setBaseWorldTransform(btTransform(btQuaternion::getIdentity(), at));
      body.setCanSleep(false);
      auto& collider = *colliders.emplace_back(std::make_unique<btMultiBodyLinkCollider>(&body, -1));
      collider.setCollisionShape(&stone);
      collider.setFriction(btScalar(0.5));
      collider.setWorldTransform(body.getBaseWorldTransform());
      body.setBaseCollider(&collider);
      world.addCollisionObject(&collider, 1, 3);
      world.addMultiBody(&body);
    }
  }
  ~Dominoes() {
    for (const auto& body : bodies) world.removeMultiBody(body.get());
    for (const auto& collider : colliders) world.removeCollisionObject(collider.get());
    world.removeCollisionObject(&table);
  }
  int sweeps(int steps) {
    int sweeps = 0;
    for (int i = 0; i < steps; ++i) {
      world.stepSimulation(btScalar(1) / 240, 0);
      btAlignedObjectArray<btSolverAnalyticsData> islands;
      world.getAnalyticsData(islands);
      for (int k = 0; k < islands.size(); ++k) sweeps += islands[k].m_numIterationsUsed;
    }
    return sweeps;
  }

  BulletPenetrationDepthSolver solver;
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btMultiBodyConstraintSolver rows;
  btMultiBodyDynamicsWorld world{&dispatcher, &broadphase, &rows, &configuration};
  btBoxShape top{btVector3(5, 5, 5)};
  btBoxShape box{btVector3(btScalar(0.015), btScalar(0.025), btScalar(0.075))};
  btCompoundShape stone;
  btCollisionObject table;
  std::vector<std::unique_ptr<btMultiBody>> bodies;
  std::vector<std::unique_ptr<btMultiBodyLinkCollider>> colliders;
};

TEST(LinksOrder, DominoesSideBySideTakeHardlyMoreSweepsThanBullets) {
  Dominoes ours(true), bullets(false);
  const int ours_took = ours.sweeps(480), bullets_took = bullets.sweeps(480);
  EXPECT_LE(ours_took, 1.25 * bullets_took);
  EXPECT_EQ(points_of(ours.dispatcher), 76) << "four for each domino and for each two neighbours";
}

std::string surface_name(const testing::TestParamInfo<Surface>& instance) {
  constexpr const char* kNames[] = {"Plane", "Box", "Mesh", "Compound"};
  return kNames[static_cast<int>(instance.param)];
}

INSTANTIATE_TEST_SUITE_P(Surfaces, IdleLink,
                         testing::Values(Surface::plane, Surface::box, Surface::mesh, Surface::compound), surface_name);

}  // namespace
}  // namespace pd::test
