// Flat parts of meshes asked once a plane: the same worlds whatever the triangles, and where planes do not do.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "engine_glue/union_worlds.hpp"

namespace pd::test {
namespace {

constexpr btScalar kMargin = btScalar(.04);

/// Every kind of body that has a way to meet a plane of its own.
std::vector<btCollisionShape*> all_kinds(UnionWorld& world) {
  auto* hull = world.bullet.shape<btConvexHullShape>();
  for (int i = 0; i < 20; ++i) {
    const double turn = 2.4 * i, y = (i + .5) / 10 - 1, radius = std::sqrt(1 - y * y);
    hull->addPoint(btScalar(.3) *
                   btVector3(btScalar(radius * std::cos(turn)), btScalar(y), btScalar(radius * std::sin(turn))));
  }
  return {world.bullet.shape<btBoxShape>(btVector3(btScalar(.3), btScalar(.2), btScalar(.25))),
          hull,
          world.bullet.shape<btSphereShape>(btScalar(.25)),
          world.bullet.shape<btCapsuleShape>(btScalar(.2), btScalar(.3)),
          world.bullet.shape<btCylinderShape>(btVector3(btScalar(.25), btScalar(.3), btScalar(.25))),
          world.bullet.shape<btConeShape>(btScalar(.25), btScalar(.5))};
}

/// Bodies of all kinds that fall, tumble and slide to rest on a floor of so many cells.
struct Fall {
  explicit Fall(int cells) {
    std::vector<UnionWorld::Triangle> triangles;
    add_floor(triangles, -8, 8, -8, 8, cells, cells);
    world.fixed(world.mesh(triangles, kMargin))->setFriction(btScalar(.5));
    const std::vector<btCollisionShape*> shapes = all_kinds(world);
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      const auto k = static_cast<btScalar>(i);
      const btQuaternion turn(btVector3(1, k, btScalar(.5)).normalized(), btScalar(.7) * k);
      bodies.push_back(world.moving(shapes[i], btTransform(turn, btVector3(2 * k - 5, 1, btScalar(.3))),
                                    btVector3(1, 0, btScalar(.5))));
      bodies.back()->setFriction(btScalar(.5));
    }
  }
  UnionWorld world;
  std::vector<btRigidBody*> bodies;
};

TEST(FlatGround, TrianglesLeaveNoTrace) {
  // The same to rounding while motion does not tell roundings apart: 40 steps, some 25 of them in contact.
  Fall coarse(1);
  Fall fine(61);
  coarse.world.step(40);
  fine.world.step(40);
  for (std::size_t i = 0; i < coarse.bodies.size(); ++i) {
    const btVector3 apart =
        coarse.bodies[i]->getWorldTransform().getOrigin() - fine.bodies[i]->getWorldTransform().getOrigin();
    EXPECT_LT(apart.length(), btScalar(2e-3)) << i;
  }
  // One question a body and step, and no triangle remembered.
  fine.world.solver.reset_statistics();
  fine.world.step(1);
  EXPECT_LE(fine.world.solver.statistics().calls, static_cast<std::int64_t>(fine.bodies.size()));
}

TEST(FlatGround, PointsBelongToTheTrianglesUnderThem) {
  UnionWorld world;
  std::vector<UnionWorld::Triangle> triangles;
  add_floor(triangles, 0, 4, 0, 4, 8, 8);
  world.fixed(world.mesh(triangles, kMargin));
  world.moving(world.bullet.shape<btBoxShape>(btVector3(btScalar(.6), btScalar(.6), btScalar(.6))),
               btVector3(btScalar(2.1), btScalar(.639), btScalar(1.9)), btVector3(0, 0, 0));
  world.solver.reset_statistics();
  world.step(1);
  EXPECT_EQ(world.solver.statistics().calls, 1);
  ASSERT_EQ(world.bullet.dispatcher().getNumManifolds(), 1);
  const btPersistentManifold& manifold = *world.bullet.dispatcher().getManifoldByIndexInternal(0);
  ASSERT_EQ(manifold.getNumContacts(), 4);
  const bool mesh_is_a = manifold.getBody0()->getCollisionShape()->isConcave();
  for (int i = 0; i < 4; ++i) {
    const btManifoldPoint& point = manifold.getContactPoint(i);
    const int index = mesh_is_a ? point.m_index0 : point.m_index1;
    ASSERT_GE(index, 0);
    ASSERT_LT(index, static_cast<int>(triangles.size()));
    const UnionWorld::Triangle& under = triangles[static_cast<std::size_t>(index)];
    const btVector3 at = mesh_is_a ? point.getPositionWorldOnA() : point.getPositionWorldOnB();
    for (std::size_t k = 0; k < 3; ++k) {
      const btVector3 inward = btVector3(0, 1, 0).cross(under[(k + 1) % 3] - under[k]);
      EXPECT_GE(inward.dot(at - under[k]), btScalar(-1e-4)) << i;
    }
    EXPECT_NEAR(static_cast<double>(at.y()), .04, 1e-6);
  }
}

TEST(FlatGround, ACornerOfARoomIsThreePlanes) {
  UnionWorld world;
  std::vector<UnionWorld::Triangle> triangles;
  add_floor(triangles, 0, 4, 0, 4, 8, 8);
  const auto wall = [&](bool along_x) {
    for (int i = 0; i < 8; ++i) {
      for (int k = 0; k < 8; ++k) {
        const auto at = [&](int u, int v) {
          return along_x ? btVector3(btScalar(.5) * btScalar(u), btScalar(.5) * btScalar(v), 0)
                         : btVector3(0, btScalar(.5) * btScalar(u), btScalar(.5) * btScalar(v));
        };
        add_rectangle(triangles, at(i, k), at(i + 1, k), at(i + 1, k + 1), at(i, k + 1));
      }
    }
  };
  wall(true);
  wall(false);
  world.fixed(world.mesh(triangles, kMargin));
  auto* sphere = world.moving(world.bullet.shape<btSphereShape>(btScalar(.4)),
                              btVector3(btScalar(.439), btScalar(.439), btScalar(.439)), btVector3(0, 0, 0));
  world.solver.reset_statistics();
  world.step(1);
  EXPECT_EQ(world.solver.statistics().calls, 3);
  EXPECT_EQ(world.bullet.num_contacts(), 3);
  world.step(60);
  EXPECT_NEAR(static_cast<double>(sphere->getWorldTransform().getOrigin().y()), .44, 2e-3);
}

/// Whether a box that starts at rest at `at` stays there for a second, over a floor with a hole.
class OverAHole : public ::testing::TestWithParam<double> {};

TEST_P(OverAHole, ABodyFallsWhereItsMiddleDoes) {
  // The floor ends at x = 0; the box reaches .3 to each side of its middle.
  const double middle = GetParam();
  UnionWorld world;
  std::vector<UnionWorld::Triangle> triangles;
  add_floor(triangles, -4, 0, -2, 2, 16, 16);
  world.fixed(world.mesh(triangles, kMargin))->setFriction(1);
  auto* box = world.moving(world.bullet.shape<btBoxShape>(btVector3(btScalar(.3), btScalar(.2), btScalar(.3))),
                           btVector3(btScalar(middle), btScalar(.24), 0), btVector3(0, 0, 0));
  box->setFriction(1);
  world.step(60);
  const double height = static_cast<double>(box->getWorldTransform().getOrigin().y());
  if (middle > .05) {
    EXPECT_LT(height, 0);
  } else {
    EXPECT_NEAR(height, .24, 2e-3);
  }
}

INSTANTIATE_TEST_SUITE_P(Middles, OverAHole, ::testing::Values(-1.0, -.35, -.29, -.1, .1, .25));

TEST(FlatGround, ATriangleThatIsMissingInTheMiddle) {
  // A ball smaller than the hole falls through it, a box larger than the hole does not.
  UnionWorld world;
  std::vector<UnionWorld::Triangle> triangles;
  add_floor(triangles, -2, 2, -2, 2, 5, 5);
  triangles.erase(triangles.begin() + 24, triangles.begin() + 26);  // the cell of .8 m about the origin
  world.fixed(world.mesh(triangles, kMargin));
  auto* ball =
      world.moving(world.bullet.shape<btSphereShape>(btScalar(.2)), btVector3(0, btScalar(.5), 0), btVector3(0, 0, 0));
  world.step(60);
  EXPECT_LT(static_cast<double>(ball->getWorldTransform().getOrigin().y()), -1);
  auto* box = world.moving(world.bullet.shape<btBoxShape>(btVector3(btScalar(.7), btScalar(.2), btScalar(.7))),
                           btVector3(0, btScalar(.25), 0), btVector3(0, 0, 0));
  world.step(120);
  EXPECT_NEAR(static_cast<double>(box->getWorldTransform().getOrigin().y()), .24, 2e-3);
}

TEST(FlatGround, ARidgeIsNoPlane) {
  // A ball on a roof's ridge touches no plane within its triangles: it is asked triangle by triangle and stays up.
  UnionWorld world;
  std::vector<UnionWorld::Triangle> triangles;
  const auto at = [](double x, double y, double z) { return btVector3(btScalar(x), btScalar(y), btScalar(z)); };
  for (double z = -2; z < 2; z += .25) {
    add_rectangle(triangles, at(-2, -1, z), at(-2, -1, z + .25), at(0, 0, z + .25), at(0, 0, z));
    add_rectangle(triangles, at(0, 0, z), at(0, 0, z + .25), at(2, -1, z + .25), at(2, -1, z));
  }
  world.fixed(world.mesh(triangles, kMargin));
  auto* ball = world.moving(world.bullet.shape<btSphereShape>(btScalar(.3)), btVector3(0, btScalar(.339), 0),
                            btVector3(0, 0, 0));
  world.solver.reset_statistics();
  world.step(1);
  EXPECT_GT(world.solver.statistics().calls, 2);
  world.step(30);
  EXPECT_NEAR(static_cast<double>(ball->getWorldTransform().getOrigin().y()), .34, 2e-3);
}

TEST(FlatGround, ASheetHasTwoSidesUnlessItIsToldOtherwise) {
  // Below the floor, pushed up against it.
  for (const bool one_sided : {false, true}) {
    BulletSolverSettings settings;
    settings.one_sided_meshes = one_sided;
    UnionWorld world(true, settings);
    world.bullet.world().setGravity(btVector3(0, btScalar(9.81), 0));
    std::vector<UnionWorld::Triangle> triangles;
    add_floor(triangles, -2, 2, -2, 2, 8, 8);
    world.fixed(world.mesh(triangles, kMargin));
    auto* box = world.moving(world.bullet.shape<btBoxShape>(btVector3(btScalar(.3), btScalar(.2), btScalar(.3))),
                             btVector3(0, btScalar(-.5), 0), btVector3(0, 0, 0));
    world.step(120);
    const double height = static_cast<double>(box->getWorldTransform().getOrigin().y());
    if (one_sided) {
      EXPECT_GT(height, .2);
    } else {
      EXPECT_NEAR(height, -.24, 2e-3);
    }
  }
}

}  // namespace
}  // namespace pd::test
