// Triangles far larger and far smaller than the bodies on them, slivers, and grounds far from the origin.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine_glue/union_worlds.hpp"

namespace pd::test {
namespace {

constexpr bool kDouble = sizeof(btScalar) == 8;

btVector3 at(double x, double y, double z) { return {btScalar(x), btScalar(y), btScalar(z)}; }

struct Ground {
  double cell_x;  ///< edges of its triangles, m
  double cell_z;
  double body;      ///< half extent of the box that slides on it
  double from = 0;  ///< of its middle from the origin
};

/// A box slides over a flat mesh without friction, three times its own length: keeps its speed, and its height.
void slide(const Ground& ground) {
  SCOPED_TRACE(testing::Message() << ground.cell_x << " x " << ground.cell_z << " m, box of " << 2 * ground.body
                                  << " m, " << ground.from << " m from the origin");
  UnionWorld world;
  const double extent = 8 * ground.body;
  const int along = std::max(1, static_cast<int>(2 * extent / ground.cell_x));
  const int across = std::max(1, static_cast<int>(4 * ground.body / ground.cell_z));
  const double x = std::max(extent, 0.5 * ground.cell_x);
  const double z = std::max(2 * ground.body, 0.5 * ground.cell_z);
  std::vector<UnionWorld::Triangle> triangles;
  // The diagonal of a single cell would run under the box: 0.3 beside it.
  add_floor(triangles, -x, x, -z + 0.3 * ground.body, z + 0.3 * ground.body, along, across);
  world.fixed(world.mesh(triangles, 0), at(ground.from, 0.5 * ground.from, ground.from));
  const double rest = 0.5 * ground.from + ground.body;
  const double speed = 4 * ground.body;
  btRigidBody* body = world.moving(box_hull(world.bullet, at(ground.body, ground.body, ground.body), 0),
                                   at(ground.from - 4 * ground.body, rest, ground.from), at(speed, 0, 0));
  double hop = 0;
  for (int i = 0; i < 360; ++i) {
    world.bullet.world().stepSimulation(btScalar(1) / 240, 0);
    hop = std::max(hop, std::abs(static_cast<double>(body->getWorldTransform().getOrigin().y()) - rest));
  }
  const double unit = std::max(ground.body, ground.from * (kDouble ? 1e-9 : 1e-3));
  EXPECT_LT(hop, 1e-3 * unit);
  EXPECT_NEAR(static_cast<double>(body->getLinearVelocity().x()), speed, 2e-3 * speed);
  EXPECT_NEAR(static_cast<double>(body->getWorldTransform().getOrigin().x()) - ground.from, 2 * ground.body,
              0.02 * unit);
  EXPECT_LT(static_cast<double>(body->getAngularVelocity().length()), 2e-3);
}

TEST(MeshSizes, TrianglesOfAMillimetreToAThousandKilometres) {
  for (const double cell : {1e-3, 1e-2, 1e-1, 1.0, 1e3, 1e6}) {
    for (const double body : {0.01, 0.4}) {
      if (cell < 0.05 * body) continue;  // ten thousand triangles at once
      slide({cell, cell, body});
    }
  }
}

TEST(MeshSizes, Slivers) {
  slide({1e-3, 1, 0.05});
  slide({1, 1e-3, 0.05});
  slide({1e3, 0.05, 0.4});
  slide({0.05, 1e4, 0.4});
}

TEST(MeshSizes, FarFromTheOrigin) {
  for (const double from : {1e2, 1e4, 1e6}) {
    if (!kDouble && from > 1e2) continue;  // a position in single precision knows .001 m there at best
    slide({1, 1, 0.4, from});
    slide({1e3, 1e3, 0.4, from});
  }
}

/// On a slope that is one triangle of a thousand kilometres, far from its middle, a box stays where it is put.
TEST(MeshSizes, ASlopeOfOneTriangle) {
  const double size = kDouble ? 1e6 : 1e2;
  const double rise = 0.2;
  UnionWorld world;
  world.bullet.world().setGravity(at(0, -9.81, 0));
  const auto corner = [&](double x, double z) { return at(x, rise * x, z); };
  btRigidBody* ground = world.fixed(world.mesh({{corner(-size, -size), corner(0, size), corner(size, -size)}}, 0));
  ground->setFriction(1);
  const double x = 0.3 * size;
  const double turn = std::atan(rise);
  const double half = 0.4;
  const btVector3 normal = at(-std::sin(turn), std::cos(turn), 0);
  btRigidBody* body = world.moving(
      box_hull(world.bullet, at(half, half, half), 0),
      btTransform(btQuaternion(at(0, 0, 1), btScalar(turn)), corner(x, -0.6 * size) + btScalar(half) * normal),
      at(0, 0, 0));
  body->setFriction(1);
  for (int i = 0; i < 240; ++i) world.step();
  const btVector3 here = body->getWorldTransform().getOrigin();
  const double height = static_cast<double>((here - corner(x, -0.6 * size)).dot(normal)) - half;
  EXPECT_NEAR(height, 0, kDouble ? 1e-5 : 1e-3);
  EXPECT_NEAR(static_cast<double>(here.x()), x + half * static_cast<double>(normal.x()), kDouble ? 1e-5 : 2e-3);
}

}  // namespace
}  // namespace pd::test
