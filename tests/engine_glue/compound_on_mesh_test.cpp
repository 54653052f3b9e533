// Compounds on meshes are one pair: their children share the mesh around them, flat ground and one choice of points.
#include <BulletCollision/CollisionDispatch/btCompoundCollisionAlgorithm.h>
#include <BulletCollision/CollisionShapes/btStaticPlaneShape.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include "engine_glue/union_worlds.hpp"
#include "pd/bullet/snapshot.hpp"

namespace pd::test {
namespace {

constexpr btScalar kMargin = btScalar(.04);

btVector3 vector(double x, double y, double z) { return {btScalar(x), btScalar(y), btScalar(z)}; }
btTransform at(double x, double y, double z) { return btTransform(btQuaternion::getIdentity(), vector(x, y, z)); }

double height_of(const btRigidBody& body) { return static_cast<double>(body.getWorldTransform().getOrigin().y()); }

/// A floor of cells of .4 m, which waves unless its height is 0.
btBvhTriangleMeshShape* ground(UnionWorld& world, double height) {
  std::vector<UnionWorld::Triangle> triangles;
  const auto corner = [&](int i, int k) {
    const double x = .4 * i - 4, z = .4 * k - 4;
    return vector(x, height * std::sin(2 * x) * std::cos(2 * z), z);
  };
  for (int i = 0; i < 20; ++i) {
    for (int k = 0; k < 20; ++k) {
      add_rectangle(triangles, corner(i, k), corner(i, k + 1), corner(i + 1, k + 1), corner(i + 1, k));
    }
  }
  return world.mesh(triangles, kMargin);
}

/// Two boxes of .4 m, 1.2 m apart.
btCompoundShape* dumbbell(UnionWorld& world) {
  auto* shape = world.bullet.shape<btCompoundShape>();
  auto* end = world.bullet.shape<btBoxShape>(vector(.2, .2, .2));
  shape->addChildShape(at(-.6, 0, 0), end);
  shape->addChildShape(at(.6, 0, 0), end);
  return shape;
}

/// Two bars across each other and a ball.
btCompoundShape* crossed_bars(UnionWorld& world) {
  auto* shape = world.bullet.shape<btCompoundShape>();
  shape->addChildShape(at(.15, 0, 0), world.bullet.shape<btBoxShape>(vector(.15, .06, .06)));
  shape->addChildShape(at(0, .15, 0), world.bullet.shape<btBoxShape>(vector(.06, .15, .06)));
  shape->addChildShape(at(0, 0, .18), world.bullet.shape<btSphereShape>(btScalar(.09)));
  return shape;
}

/// Of the points of the world's manifolds, the number of the compound's child.
std::multiset<int> children_with_points(UnionWorld& world) {
  std::multiset<int> children;
  for (int m = 0; m < world.bullet.dispatcher().getNumManifolds(); ++m) {
    const btPersistentManifold& manifold = *world.bullet.dispatcher().getManifoldByIndexInternal(m);
    const bool compound_is_a = manifold.getBody0()->getCollisionShape()->isCompound();
    for (int k = 0; k < manifold.getNumContacts(); ++k) {
      const btManifoldPoint& point = manifold.getContactPoint(k);
      children.insert(compound_is_a ? point.m_index0 : point.m_index1);
    }
  }
  return children;
}

TEST(CompoundOnMesh, ChildrenShareFourPointsOfAFloor) {
  UnionWorld world;
  world.fixed(ground(world, 0));
  const btRigidBody* body = world.moving(dumbbell(world), vector(0, .239, 0), vector(0, 0, 0));
  world.solver.reset_statistics();
  world.step(1);
  EXPECT_EQ(world.solver.statistics().calls, 2);  // a plane and child
  EXPECT_EQ(world.bullet.dispatcher().getNumManifolds(), 1);
  // Two at each end, as far out as they go.
  EXPECT_EQ(children_with_points(world), (std::multiset<int>{0, 0, 1, 1}));
  const btPersistentManifold& manifold = *world.bullet.dispatcher().getManifoldByIndexInternal(0);
  for (int k = 0; k < manifold.getNumContacts(); ++k) {
    const btVector3& point = manifold.getContactPoint(k).getPositionWorldOnB();
    EXPECT_NEAR(std::abs(static_cast<double>(point.x())), .8, 1e-3);
    EXPECT_NEAR(std::abs(static_cast<double>(point.z())), .2, 1e-3);
  }
  world.step(120);
  EXPECT_NEAR(height_of(*body), .24, 2e-3);
}

TEST(CompoundOnMesh, TrianglesOfAFloorLeaveNoTrace) {
  const auto fall = [](UnionWorld& world, int cells) {
    std::vector<UnionWorld::Triangle> triangles;
    add_floor(triangles, -4, 4, -4, 4, cells, cells);
    world.fixed(world.mesh(triangles, kMargin))->setFriction(btScalar(.5));
    const btQuaternion turn(vector(1, .4, .5).normalized(), btScalar(.7));
    btRigidBody* body = world.moving(crossed_bars(world), btTransform(turn, vector(.1, .5, .3)), vector(.5, 0, .25));
    body->setFriction(btScalar(.5));
    return body;
  };
  UnionWorld coarse, fine;
  const btRigidBody* on_coarse = fall(coarse, 1);
  const btRigidBody* on_fine = fall(fine, 61);
  coarse.step(40);
  fine.step(40);
  const btVector3 apart = on_coarse->getWorldTransform().getOrigin() - on_fine->getWorldTransform().getOrigin();
  EXPECT_LT(apart.length(), btScalar(2e-3));
  fine.solver.reset_statistics();
  fine.step(1);
  EXPECT_LE(fine.solver.statistics().calls, 3);
}

TEST(CompoundOnMesh, WhatLiesInsideOfAnotherChildHasNoPoints) {
  // A block on its lower edge, and a small one inside of it whose edge is 3 mm above that.
  UnionWorld world;
  world.fixed(ground(world, 0));
  auto* shape = world.bullet.shape<btCompoundShape>();
  shape->addChildShape(at(0, 0, 0), world.bullet.shape<btBoxShape>(vector(.3, .3, .3)));
  const double inward = .003 / (std::cos(.3) + std::sin(.3));
  shape->addChildShape(at(.25 - inward, -.25 + inward, 0), world.bullet.shape<btBoxShape>(vector(.05, .05, .05)));
  const double above = .3 * (std::cos(.3) + std::sin(.3));
  world.moving(shape, btTransform(btQuaternion(vector(0, 0, 1), btScalar(-.3)), vector(0, above + .0399, 0)),
               vector(0, 0, 0));
  world.step(1);
  EXPECT_EQ(children_with_points(world), (std::multiset<int>{0, 0}));
}

TEST(CompoundOnMesh, WhatASheetCutsLeavesWhereTheWholeIs) {
  // Upside down: the upright bar stands through the sheet by two thirds, so that its own way out is down, the other
  // bar lies on it.
  UnionWorld world;
  world.fixed(ground(world, 0))->setFriction(btScalar(.5));
  const btQuaternion over(vector(1, 0, 0), SIMD_PI);
  const btRigidBody* body = world.moving(crossed_bars(world), btTransform(over, vector(.1, .1, .1)), vector(0, 0, 0));
  world.step(180);
  EXPECT_GT(world.bullet.least_distance(), -2e-3);
  EXPECT_GT(height_of(*body), .05);
}

bool only_balls(const btCollisionShape*, const btCollisionShape* child) {
  return child->getShapeType() == SPHERE_SHAPE_PROXYTYPE;
}

TEST(CompoundOnMesh, TheHostChoosesChildren) {
  UnionWorld world;
  world.fixed(ground(world, 0));
  const btRigidBody* body = world.moving(crossed_bars(world), vector(0, .129, 0), vector(0, 0, 0));
  gCompoundChildShapePairCallback = only_balls;
  world.step(1);
  gCompoundChildShapePairCallback = nullptr;
  EXPECT_EQ(children_with_points(world), (std::multiset<int>{2}));
  EXPECT_GT(height_of(*body), 0);
}

TEST(CompoundOnMesh, RestsOnWaves) {
  UnionWorld world;
  world.fixed(ground(world, .15))->setFriction(btScalar(.8));
  std::vector<btRigidBody*> bodies;
  for (int i = 0; i < 9; ++i) {
    const btQuaternion turn(vector(1, .3 * i, .5).normalized(), btScalar(.7 * i));
    bodies.push_back(
        world.moving(crossed_bars(world), btTransform(turn, vector(i % 3 - 1, 1, i / 3 - 1)), vector(0, 0, 0)));
    bodies.back()->setFriction(btScalar(.8));
    bodies.back()->setRollingFriction(btScalar(.02));
    bodies.back()->setSpinningFriction(btScalar(.02));
  }
  double deepest = 0;
  for (int i = 0; i < 480; ++i) {
    world.step();
    if (i >= 240) deepest = std::min(deepest, world.bullet.least_distance());
  }
  EXPECT_GT(deepest, -2e-3);
  for (const btRigidBody* body : bodies) {
    EXPECT_GT(height_of(*body), -.2);
    EXPECT_LT(static_cast<double>(body->getLinearVelocity().length()), .05);
  }
}

TEST(CompoundOnMesh, AReplayIsBitForBit) {
  UnionWorld world;
  world.fixed(ground(world, .1))->setFriction(btScalar(.5));
  std::vector<btRigidBody*> bodies;
  for (int i = 0; i < 6; ++i) {
    const btQuaternion turn(vector(1, i, .5).normalized(), btScalar(.7 * i));
    bodies.push_back(
        world.moving(crossed_bars(world), btTransform(turn, vector(.7 * i - 2, .6, .1)), vector(.5, 0, .1 * i)));
    bodies.back()->setFriction(btScalar(.5));
  }
  world.step(40);
  const BulletSnapshot saved(world.bullet.world(), &world.solver);
  std::vector<btTransform> first;
  world.step(30);
  for (const btRigidBody* body : bodies) first.push_back(body->getWorldTransform());
  ASSERT_EQ(saved.restore(), Restored::yes);
  world.step(30);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    EXPECT_TRUE(bodies[i]->getWorldTransform() == first[i]) << i;
  }
}

TEST(CompoundOnMesh, AChildWithoutExactFormLeavesThePairToBullet) {
  UnionWorld world;
  world.fixed(ground(world, 0));
  const btVector3 centres[] = {vector(-.2, 0, 0), vector(.2, 0, 0)};
  const btScalar radii[] = {btScalar(.2), btScalar(.1)};
  auto* spheres = world.bullet.shape<btMultiSphereShape>(centres, radii, 2);
  spheres->setLocalScaling(vector(1, 2, 1));
  auto* shape = world.bullet.shape<btCompoundShape>();
  shape->addChildShape(at(0, 0, 0), spheres);
  shape->addChildShape(at(.8, 0, 0), world.bullet.shape<btBoxShape>(vector(.2, .2, .2)));
  const btRigidBody* body = world.moving(shape, vector(0, .6, 0), vector(0, 0, 0));
  world.step(120);
  EXPECT_GT(height_of(*body), .1);
  EXPECT_GT(world.bullet.num_contacts(), 0);
}

/// Counts the triangles that it offers.
class CountingMesh : public btBvhTriangleMeshShape {
 public:
  using btBvhTriangleMeshShape::btBvhTriangleMeshShape;
  void processAllTriangles(btTriangleCallback* callback, const btVector3& lower,
                           const btVector3& upper) const override {
    struct Counter : btTriangleCallback {
      Counter(btTriangleCallback& to, int& count) : to_(to), count_(count) {}
      void processTriangle(btVector3* corners, int part, int index) override {
        ++count_;
        to_.processTriangle(corners, part, index);
      }
      btTriangleCallback& to_;
      int& count_;
    } counter(*callback, offered);
    btBvhTriangleMeshShape::processAllTriangles(&counter, lower, upper);
  }
  mutable int offered = 0;
};

/// Children at three corners of 20,000 triangles: between them lie triangles that none of them meets.
TEST(CompoundOnMesh, ChildrenFarApartReadTheMeshRoundThemselves) {
  UnionWorld world;
  std::vector<UnionWorld::Triangle> triangles;
  add_floor(triangles, -50, 50, -50, 50, 100, 100);
  world.mesh(triangles, kMargin);
  auto* mesh = world.bullet.shape<CountingMesh>(world.meshes.back().get(), true);
  mesh->setMargin(kMargin);
  world.fixed(mesh);
  auto* shape = world.bullet.shape<btCompoundShape>();
  auto* end = world.bullet.shape<btBoxShape>(vector(.2, .2, .2));
  for (const auto& [x, z] : {std::pair{-40, -40}, std::pair{40, -40}, std::pair{0, 40}}) {
    shape->addChildShape(at(x, 0, z), end);
  }
  world.moving(shape, vector(.5, .239, .5), vector(0, 0, 0));
  world.step(1);
  // Bullet lets contacts reach 1.1 m where a body has a radius of 57.
  EXPECT_LT(mesh->offered, 1000);
  const std::multiset<int> children = children_with_points(world);
  for (int child = 0; child < 3; ++child) EXPECT_GE(children.count(child), 1U) << child;
}

/// More triangles round a body than are compared one by one: what lies round a contact comes from the mesh's tree.
TEST(CompoundOnMesh, AFineMeshHoldsASlabAsACoarseOneDoes) {
  UnionWorld world;
  std::vector<UnionWorld::Triangle> triangles;
  const auto corner = [](int i, int k) {
    const double x = .1 * i - 3, z = .1 * k - 3;
    return vector(x, .02 * std::sin(4 * x) * std::cos(4 * z), z);
  };
  for (int i = 0; i < 60; ++i) {
    for (int k = 0; k < 60; ++k) {
      add_rectangle(triangles, corner(i, k), corner(i, k + 1), corner(i + 1, k + 1), corner(i + 1, k));
    }
  }
  world.fixed(world.mesh(triangles, kMargin));
  auto* shape = world.bullet.shape<btCompoundShape>();
  shape->addChildShape(at(0, 0, 0), world.bullet.shape<btBoxShape>(vector(1, .1, 1)));
  shape->addChildShape(at(0, .3, 0), world.bullet.shape<btBoxShape>(vector(.2, .2, .2)));
  const btRigidBody* body = world.moving(shape, vector(0, .17, 0), vector(.5, 0, 0));
  world.step(60);
  // It slides over the crests: no edge between triangles holds it.
  EXPECT_NEAR(static_cast<double>(body->getLinearVelocity().x()), .5, .05);
  EXPECT_NEAR(height_of(*body), .16, .01);
}

TEST(CompoundOnMesh, AChildWhosePlaceIsNoNumberIsLeftOut) {
  for (const bool plane : {false, true}) {
    for (const int broken : {0, 1, 2}) {
      UnionWorld world;
      world.fixed(plane ? static_cast<btCollisionShape*>(
                              world.bullet.shape<btStaticPlaneShape>(vector(0, 1, 0), btScalar(kMargin)))
                        : ground(world, 0));
      auto* shape = world.bullet.shape<btCompoundShape>(false);
      auto* box = world.bullet.shape<btBoxShape>(vector(.2, .2, .2));
      for (int i = 0; i < 3; ++i) shape->addChildShape(at(.6 * i - .6, i == broken ? std::nan("") : 0, 0), box);
      btRigidBody* body = world.moving(dumbbell(world), vector(0, .239, 0), vector(0, 0, 0));
      // Broadphase boxes are those of the sound shape.
      world.bullet.world().updateAabbs();
      body->setCollisionShape(shape);
      world.bullet.world().performDiscreteCollisionDetection();
      const std::multiset<int> children = children_with_points(world);
      for (int child = 0; child < 3; ++child) {
        EXPECT_EQ(children.count(child) > 0, child != broken) << plane << ' ' << broken << ' ' << child;
      }
    }
  }
}

}  // namespace
}  // namespace pd::test
