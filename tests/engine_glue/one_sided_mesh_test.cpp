// Meshes as surfaces of solids: back faces push out by the front, and nothing else changes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine_glue/union_worlds.hpp"

namespace pd::test {
namespace {

using Triangles = std::vector<UnionWorld::Triangle>;

btVector3 at(double x, double y, double z) { return {btScalar(x), btScalar(y), btScalar(z)}; }
double y_of(const btRigidBody& body) { return static_cast<double>(body.getWorldTransform().getOrigin().y()); }
double x_of(const btRigidBody& body) { return static_cast<double>(body.getWorldTransform().getOrigin().x()); }

BulletSolverSettings one_sided() {
  BulletSolverSettings settings;
  settings.one_sided_meshes = true;
  return settings;
}

/// The surface of [-half, half]^3 + middle, `cells` squares along an edge, facing out.
void add_block(Triangles& into, const btVector3& middle, const btVector3& half, int cells) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const int side : {-1, 1}) {
      const int u = (axis + 1) % 3;
      const int v = (axis + 2) % 3;
      const auto corner = [&](int i, int k) {
        btVector3 p;
        p[axis] = btScalar(side) * half[axis];
        p[u] = half[u] * (btScalar(2 * i) / btScalar(cells) - 1);
        p[v] = half[v] * (btScalar(2 * k) / btScalar(cells) - 1);
        return btVector3(middle + p);
      };
      for (int i = 0; i < cells; ++i) {
        for (int k = 0; k < cells; ++k) {
          if (side > 0) {
            add_rectangle(into, corner(i, k), corner(i + 1, k), corner(i + 1, k + 1), corner(i, k + 1));
          } else {
            add_rectangle(into, corner(i, k), corner(i, k + 1), corner(i + 1, k + 1), corner(i + 1, k));
          }
        }
      }
    }
  }
}

btBvhTriangleMeshShape* floor_mesh(UnionWorld& world, double cell) {
  Triangles triangles;
  const int cells = static_cast<int>(8 / cell);
  add_floor(triangles, -4, 4, -4, 4, cells, cells);
  return world.mesh(triangles, 0);
}

btCollisionShape* small_body(UnionWorld& world, int kind) {
  if (kind == 0) return world.bullet.shape<btSphereShape>(btScalar(.4));
  if (kind == 1) return world.bullet.shape<btBoxShape>(at(.4, .4, .4));
  if (kind == 2) return box_hull(world.bullet, at(.4, .4, .4), 0);
  return world.bullet.shape<btCylinderShape>(at(.4, .4, .4));
}

TEST(OneSidedMesh, WhatIsMostlyBehindLeavesByTheFront) {
  for (const bool field : {false, true}) {
    for (int kind = 0; kind < 4; ++kind) {
      SCOPED_TRACE(testing::Message() << (field ? "heightfield " : "mesh ") << kind);
      for (const bool one : {true, false}) {
        UnionWorld world(true, one ? one_sided() : BulletSolverSettings());
        world.fixed(field ? static_cast<btCollisionShape*>(flat_heightfield(world, 17, btScalar(.5), 0))
                          : floor_mesh(world, .25));
        const btRigidBody* body = world.moving(small_body(world, kind), at(.1, -.2, .07), at(0, 0, 0));
        double highest = -1;
        for (int i = 0; i < 240; ++i) {
          world.step();
          highest = std::max(highest, y_of(*body));
        }
        if (one) {
          EXPECT_NEAR(y_of(*body), .4, .01);
          EXPECT_LT(highest, .6);
          EXPECT_LT(std::abs(x_of(*body) - .1), .05);
        } else {
          EXPECT_LT(y_of(*body), -1);  // a sheet: the shorter way out is down
        }
      }
    }
  }
}

TEST(OneSidedMesh, WhatIsBehindAndApartMeetsNothing) {
  for (int kind = 0; kind < 4; ++kind) {
    UnionWorld world(true, one_sided());
    world.bullet.world().setGravity(at(0, 0, 0));
    world.fixed(floor_mesh(world, .5));
    const btRigidBody* body = world.moving(small_body(world, kind), at(.1, -.41, .07), at(1, 0, 0));
    world.step(60);
    EXPECT_EQ(world.bullet.dispatcher().getNumManifolds() == 0 ||
                  world.bullet.dispatcher().getManifoldByIndexInternal(0)->getNumContacts() == 0,
              true)
        << kind;
    EXPECT_NEAR(y_of(*body), -.41, 1e-4) << kind;
    EXPECT_NEAR(x_of(*body), 1.1, 1e-3) << kind;
  }
}

/// A closed block of small triangles with a body anywhere in it: out, by one of its faces, and it stays out.
TEST(OneSidedMesh, NothingStaysInAClosedBlock) {
  for (const int cells : {1, 5}) {
    for (int start = 0; start < 6; ++start) {
      UnionWorld world(true, one_sided());
      world.bullet.world().setGravity(at(0, 0, 0));
      Triangles triangles;
      add_block(triangles, at(0, 0, 0), at(1, 1, 1), cells);
      world.fixed(world.mesh(triangles, 0));
      btVector3 place(btScalar(.1), btScalar(-.15), btScalar(.05));
      place[start % 3] = btScalar(start < 3 ? .8 : -.8);
      btRigidBody* body = world.moving(world.bullet.shape<btBoxShape>(at(.3, .3, .3)), place, at(0, 0, 0));
      body->setDamping(btScalar(.5), btScalar(.5));
      world.step(240);
      const btVector3 out = body->getWorldTransform().getOrigin();
      EXPECT_GT(static_cast<double>(std::abs(out[start % 3])), 1.25) << cells << ' ' << start;
      EXPECT_LT(static_cast<double>(std::abs(out[(start + 1) % 3])), .4) << cells << ' ' << start;
    }
  }
}

/// Sunk by more than it hangs over: up, and not through the wall that its rim stands behind.
TEST(OneSidedMesh, ABoxSunkAtARimRisesStraight) {
  UnionWorld world(true, one_sided());
  Triangles triangles;
  add_block(triangles, at(0, -1, 0), at(1, 1, 1), 4);
  world.fixed(world.mesh(triangles, 0));
  btRigidBody* body = world.moving(world.bullet.shape<btBoxShape>(at(.5, .5, .5)), at(.6, .3, 0), at(0, 0, 0));
  double fastest = 0;
  for (int i = 0; i < 120; ++i) {
    world.step();
    fastest = std::max(fastest, std::abs(static_cast<double>(body->getLinearVelocity().x())));
  }
  EXPECT_NEAR(y_of(*body), .5, .02);
  EXPECT_NEAR(x_of(*body), .6, .02);
  EXPECT_LT(fastest, .2);
}

/// In front nothing changes: the same bits as a sheet's.
TEST(OneSidedMesh, ASlideAndAKerbAreAsEver) {
  std::vector<btScalar> ways[2];
  for (const bool one : {false, true}) {
    UnionWorld world(true, one ? one_sided() : BulletSolverSettings());
    Triangles triangles;
    add_floor(triangles, -4, 4, -2, 2, 16, 8);
    add_block(triangles, at(2.5, .05, 0), at(.5, .05, 2), 3);
    world.fixed(world.mesh(triangles, 0));
    const btRigidBody* body = world.moving(world.bullet.shape<btBoxShape>(at(.4, .4, .4)), at(-2, .4, .1), at(3, 0, 0));
    for (int i = 0; i < 180; ++i) {
      world.step();
      for (int k = 0; k < 3; ++k) ways[one].push_back(body->getWorldTransform().getOrigin()[k]);
    }
  }
  EXPECT_EQ(ways[0], ways[1]);
}

}  // namespace
}  // namespace pd::test
