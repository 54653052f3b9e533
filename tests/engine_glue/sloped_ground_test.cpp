// A plane goes on beyond its triangle. Bodies that reach over the edge of a slope lie behind its plane as a whole, and
// still stand before the slope itself.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "engine_glue/union_worlds.hpp"

namespace pd::test {
namespace {

btVector3 vector(double x, double y, double z) { return {btScalar(x), btScalar(y), btScalar(z)}; }

/// The deepest distance of two bodies in a query between steps, or 1e30 without points.
double deepest_in_query(UnionWorld& world, btCollisionObject& a, btCollisionObject& b) {
  struct Least final : btCollisionWorld::ContactResultCallback {
    double distance = 1e30;
    btScalar addSingleResult(btManifoldPoint& point, const btCollisionObjectWrapper*, int, int,
                             const btCollisionObjectWrapper*, int, int) override {
      distance = std::min(distance, static_cast<double>(point.getDistance()));
      return 0;
    }
  } least;
  world.bullet.world().contactPairTest(&a, &b, least);
  return least.distance;
}

TEST(SlopedGround, ABoardAboveOneTriangleIsNotInIt) {
  for (const bool reversed : {false, true}) {
    UnionWorld world;
    UnionWorld::Triangle triangle{vector(-0.5, 0.25, 0.25), vector(-0.5, 0.125, 0.5), vector(-0.25, 0.25, 0.5)};
    if (reversed) std::swap(triangle[1], triangle[2]);
    world.fixed(world.mesh({triangle}, 0));
    world.moving(world.bullet.shape<btBoxShape>(vector(0.5, 0.0625, 0.5)), vector(0.03, 0.3225, 0.02), vector(0, 0, 0));
    world.bullet.world().performDiscreteCollisionDetection();
    EXPECT_NEAR(world.bullet.least_distance(), 0.01, 1e-6) << reversed;
  }
}

/// Adds the sides and the top of a frustum that stands at y = 0: half widths below and above.
void add_frustum(std::vector<UnionWorld::Triangle>& into, double x, double below, double above, double height) {
  const auto corner = [&](int i, double half, double y) {
    return vector(x + (i == 0 || i == 3 ? -half : half), y, i < 2 ? -half : half);
  };
  for (int i = 0; i < 4; ++i) {
    const int k = (i + 1) % 4;
    add_rectangle(into, corner(i, below, 0), corner(i, above, height), corner(k, above, height), corner(k, below, 0));
  }
  add_rectangle(into, corner(0, above, height), corner(3, above, height), corner(2, above, height),
                corner(1, above, height));
}

TEST(SlopedGround, APlankLiesOnTwoPosts) {
  for (const bool compound : {false, true}) {
    UnionWorld world;
    std::vector<UnionWorld::Triangle> triangles;
    for (const double x : {-1.2, 1.2}) add_frustum(triangles, x, 0.4, 0.1, 1);
    world.fixed(world.mesh(triangles, 0));
    btCollisionShape* shape = world.bullet.shape<btBoxShape>(vector(compound ? 0.9 : 1.8, 0.1, 0.5));
    if (compound) {
      auto* both = world.bullet.shape<btCompoundShape>();
      for (const double x : {-0.9, 0.9}) {
        both->addChildShape(btTransform(btQuaternion::getIdentity(), vector(x, 0, 0)), shape);
      }
      shape = both;
    }
    btRigidBody* plank = world.moving(shape, vector(0, 1.12, 0), vector(0, 0, 0));
    world.step(90);
    EXPECT_NEAR(plank->getWorldTransform().getOrigin().y(), 1.1, 0.01) << compound;
  }
}

TEST(SlopedGround, WideBoxesLieOnBumps) {
  // Bumps of up to twice the cell, so that the slopes' planes cut the boxes far from the slopes.
  for (const double half : {0.5, 1.0}) {
    for (const double bump : {0.03, 0.06, 0.12, 0.24}) {
      SCOPED_TRACE(bump);
      constexpr double kCell = 0.12;
      const int cells = static_cast<int>(2.6 * half / kCell);
      const auto corner = [&](int i, int k) {
        return vector(kCell * (i - 0.5 * cells), bump / 4 * ((7 * i + 13 * k) % 5), kCell * (k - 0.5 * cells));
      };
      std::vector<UnionWorld::Triangle> triangles;
      for (int i = 0; i < cells; ++i) {
        for (int k = 0; k < cells; ++k) {
          add_rectangle(triangles, corner(i, k), corner(i, k + 1), corner(i + 1, k + 1), corner(i + 1, k));
        }
      }
      UnionWorld world;
      world.fixed(world.mesh(triangles, btScalar(CONVEX_DISTANCE_MARGIN)));
      btRigidBody* box = world.moving(world.bullet.shape<btBoxShape>(vector(half, half / 8, half)),
                                      vector(0.03, bump + half / 8 + 0.06, 0.02), vector(0, 0, 0));
      world.step(90);
      EXPECT_GT(box->getWorldTransform().getOrigin().y(), bump + 0.9 * half / 8);
    }
  }
}

/// Two cubes of half extents 1, 1 and 0.5, one above the other: their seam lies at the body's origin.
btCompoundShape* stacked_cubes(UnionWorld& world) {
  auto* both = world.bullet.shape<btCompoundShape>();
  btCollisionShape* cube = world.bullet.shape<btBoxShape>(vector(1, 0.5, 1));
  for (const double y : {-0.5, 0.5}) {
    both->addChildShape(btTransform(btQuaternion::getIdentity(), vector(0, y, 0)), cube);
  }
  return both;
}

TEST(SlopedGround, ACompoundThatStraddlesASheetLeavesOnItsMiddlesSide) {
  // Each cube's shortest way off the sheet leads into the other cube.
  for (const auto& [height, cells] : {std::pair{0.05, 1}, {0.2, 1}, {0.4, 1}, {0.2, 40}, {0.0, 40}}) {
    SCOPED_TRACE(height);
    UnionWorld world;
    std::vector<UnionWorld::Triangle> triangles;
    add_floor(triangles, -10, 10, -10, 10, cells, cells);
    btRigidBody* sheet = world.fixed(world.mesh(triangles, 0));
    btRigidBody* body = world.moving(stacked_cubes(world), vector(0.3, height, 0.2), vector(0, 0, 0));
    EXPECT_NEAR(deepest_in_query(world, *sheet, *body), height - 1, 1e-3);
    EXPECT_NEAR(deepest_in_query(world, *body, *sheet), height - 1, 1e-3);
    world.step(120);
    EXPECT_NEAR(body->getWorldTransform().getOrigin().y(), 1, 0.02);
  }
}

TEST(SlopedGround, SlopesOfAGrooveShareAManifold) {
  // Without unions as one, all triangles write into one manifold of four points.
  BulletSolverSettings settings;
  settings.unions_as_one = false;
  UnionWorld world(true, settings);
  std::vector<UnionWorld::Triangle> triangles;
  add_rectangle(triangles, vector(-3, 1, -1), vector(-3, 0, 0), vector(3, 0, 0), vector(3, 1, -1));
  add_rectangle(triangles, vector(-3, 0, 0), vector(-3, 1, 1), vector(3, 1, 1), vector(3, 0, 0));
  world.fixed(world.mesh(triangles, 0));
  btRigidBody* box =
      world.moving(world.bullet.shape<btBoxShape>(vector(0.3, 0.1, 0.1)), vector(0.05, 0.4, 0.02), vector(0, 0, 0));
  world.step(120);
  EXPECT_GT(box->getWorldTransform().getOrigin().y(), 0.1);
}

/// A field of 10 x 10 with bumps up to 4 times `bump`.
std::vector<UnionWorld::Triangle> bumpy_field(int cells, double bump) {
  const auto corner = [&](int i, int k) {
    return vector(10.0 * i / cells - 5, bump * ((7 * i + 13 * k) % 5), 10.0 * k / cells - 5);
  };
  std::vector<UnionWorld::Triangle> triangles;
  for (int i = 0; i < cells; ++i) {
    for (int k = 0; k < cells; ++k) {
      add_rectangle(triangles, corner(i, k), corner(i, k + 1), corner(i + 1, k + 1), corner(i + 1, k));
    }
  }
  return triangles;
}

TEST(SlopedGround, BodiesThatStartDeepInBumpsComeOutAbove) {
  // Their middles stand above the bumps, and each is in some hundred triangles at once.
  std::mt19937 random(11);
  const auto uniform = [&](double least, double most) {
    return least + (most - least) * (static_cast<double>(random()) / 4294967296.0);
  };
  for (int i = 0; i < 40; ++i) {
    SCOPED_TRACE(i);
    const int cells = 8 + static_cast<int>(random() % 16);
    const double bump = uniform(0.2, 2) / cells, radius = uniform(0.4, 2.8);
    UnionWorld world;
    world.fixed(world.mesh(bumpy_field(cells, bump), btScalar(CONVEX_DISTANCE_MARGIN)));
    btCollisionShape* shape = nullptr;
    const btVector3 extents = vector(uniform(0.3, 1) * radius, uniform(0.3, 1) * radius, uniform(0.3, 1) * radius);
    if (i % 3 == 0) {
      shape = world.bullet.shape<btBoxShape>(extents);
    } else {
      auto* hull = world.bullet.shape<btConvexHullShape>();
      for (int k = 0; k < 12 + i; ++k) {
        const btVector3 point = vector(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
        hull->addPoint(point.normalized() * static_cast<btScalar>(radius), false);
      }
      hull->recalcLocalAabb();
      shape = hull;
    }
    const btVector3 axis = vector(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
    const btQuaternion turn(axis.normalized(), static_cast<btScalar>(uniform(0, 6)));
    const double above = 4 * bump + uniform(0.1, 0.7) * radius;
    btRigidBody* body =
        world.moving(shape, btTransform(turn, vector(uniform(-1.5, 1.5), above, uniform(-1.5, 1.5))), vector(0, 0, 0));
    world.step(60);
    const btVector3 at = body->getWorldTransform().getOrigin();
    EXPECT_GT(at.y(), 0) << at.x() << " " << at.z();
  }
}

}  // namespace
}  // namespace pd::test
