// Bodies that start deep inside a union of many pieces leave it the shortest way.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "engine_glue/union_worlds.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "scenes/bullet/bullet_scene.hpp"
#include "scenes/bullet/convex_pieces.hpp"
#include "scenes/union_worlds.hpp"

namespace pd::test {
namespace {

btVector3 at(double x, double y, double z) { return {btScalar(x), btScalar(y), btScalar(z)}; }

/// A cube of `side` flush unit boxes to each side, centred.
btCompoundShape* block(UnionWorld& world, int side) {
  auto* compound = world.bullet.shape<btCompoundShape>();
  auto* box = world.bullet.shape<btBoxShape>(at(.5, .5, .5));
  const double first = 0.5 - 0.5 * side;
  for (int i = 0; i < side * side * side; ++i) {
    const btVector3 place = at(first + i % side, first + i / side % side, first + i / (side * side));
    compound->addChildShape(btTransform(btQuaternion::getIdentity(), place), box);
  }
  return compound;
}

/// Boxes or rounded hulls of .8 x .6 x .7, one or two in a row along x.
btCollisionShape* brick(UnionWorld& world, int count, bool rounded) {
  btConvexShape* piece = world.bullet.shape<btBoxShape>(at(.4, .3, .35));
  if (rounded) {
    auto* hull = world.bullet.shape<btConvexHullShape>();
    for (int i = 0; i < 8; ++i) {
      hull->addPoint(at(i & 1 ? .36 : -.36, i & 2 ? .26 : -.26, i & 4 ? .31 : -.31));
    }
    hull->setMargin(btScalar(.04));
    piece = hull;
  }
  if (count == 1) return piece;
  auto* compound = world.bullet.shape<btCompoundShape>();
  for (int i = 0; i < count; ++i) {
    compound->addChildShape(btTransform(btQuaternion::getIdentity(), at(.8 * (i - 0.5 * (count - 1)), 0, 0)), piece);
  }
  return compound;
}

TEST(DeepUnions, ABodyInABlockLeavesItTheShortestWay) {
  for (const double x : {0.6, 1.0, 1.4}) {
    for (const int count : {1, 2}) {
      for (const bool rounded : {false, true}) {
        SCOPED_TRACE(testing::Message() << x << ' ' << count << ' ' << rounded);
        UnionWorld world;
        world.bullet.world().setGravity(at(0, 0, 0));
        world.fixed(block(world, 4));
        const btQuaternion turned(at(1, 2, 3).normalized(), btScalar(.2));
        const btRigidBody* body =
            world.moving(brick(world, count, rounded), btTransform(turned, at(x, .2, -.1)), at(0, 0, 0));
        world.step(240);
        const btVector3& end = body->getWorldTransform().getOrigin();
        // Two in a row are .8 long to each side: from x = .6 it is nearer to leave upwards.
        const bool up = count == 2 && x < 0.7;
        EXPECT_GT(up ? end.y() : end.x(), 2.3);
        EXPECT_NEAR(static_cast<double>(up ? end.x() : end.y()), up ? x : .2, .1);
        EXPECT_NEAR(static_cast<double>(end.z()), -.1, .1);
        EXPECT_LT(body->getAngularVelocity().length(), 0.5);
        // From x = 1.4 what the outermost boxes say can be enough.
        EXPECT_TRUE(x > 1.2 || world.solver.statistics().deep_unions > 0);
        EXPECT_EQ(world.solver.statistics().deep_unions_left, 0);
      }
    }
  }
}

TEST(DeepUnions, ABodyInsideASinglePieceLeavesTheWhole) {
  for (const double x : {0.05, 0.3, 0.6, 0.7, 0.95}) {
    SCOPED_TRACE(x);
    UnionWorld world;
    world.bullet.world().setGravity(at(0, 0, 0));
    world.fixed(block(world, 3));
    auto* piece = world.bullet.shape<btBoxShape>(at(.1, .1, .1));
    const btRigidBody* body = world.moving(piece, btTransform(btQuaternion::getIdentity(), at(x, .02, 0)), at(0, 0, 0));
    world.step(240);
    const btVector3& end = body->getWorldTransform().getOrigin();
    EXPECT_GT(end.x(), 1.55);
    EXPECT_NEAR(static_cast<double>(end.y()), .02, 1e-3);
  }
}

/// Depth of the two pieces that are deepest in each other.
double deepest_of(scenes::BulletScene& scene, const std::vector<scenes::ConvexPiece>& pieces, Scratch& scratch) {
  double deepest = 0;
  scenes::for_each_near_pair(scene, pieces, [&](const scenes::PosedPiece& a, const scenes::PosedPiece& b) {
    deepest = std::max(deepest,
                       penetration_depth({a.piece.shape.get(), a.pose}, {b.piece.shape.get(), b.pose}, scratch).depth);
  });
  return deepest;
}

// As after an impact of 8 m/s, a step of .14 m: half of the pieces of one wall would leave the other wall to one side,
// half to the other. 25 pieces each take more facets than a budget of 4,096.
TEST(DeepUnions, BowlsInsideEachOtherComeApart) {
  scenes::World world;
  world.bodies.push_back(scenes::open_bowl(12, 0.5, Vec3::Zero()));
  world.bodies.push_back(scenes::open_bowl(12, 0.5, Vec3(0.007, 0.002, -0.006)));
  world.bodies[1].orientation = Eigen::AngleAxisd(0.12, Vec3::UnitY());
  world.gravity = Vec3::Zero();
  scenes::BulletScene scene(world, scenes::ContactRun::pdepth);
  const std::vector<scenes::ConvexPiece> pieces = scenes::convex_pieces(world);
  Scratch scratch;
  EXPECT_GT(deepest_of(scene, pieces, scratch), 0.04);
  for (int i = 0; i < 60; ++i) scene.step(60);
  EXPECT_LT(deepest_of(scene, pieces, scratch), 1e-3);
  const BulletSolverStatistics statistics = scene.solver().statistics();
  EXPECT_GT(statistics.deep_unions, 0);
  EXPECT_LE(statistics.deep_unions_nearly, statistics.deep_unions);
  EXPECT_EQ(statistics.deep_unions_left, 0);
}

TEST(DeepUnions, WhatRestsIsNotAsked) {
  UnionWorld world;
  world.fixed(block(world, 4));
  btRigidBody* body = world.moving(brick(world, 2, false), at(0, 2.3, 0), at(0, 0, 0));
  world.step(120);
  EXPECT_NEAR(static_cast<double>(body->getWorldTransform().getOrigin().y()), 2.3, 1e-3);
  EXPECT_EQ(world.solver.statistics().deep_unions, 0);
}

TEST(DeepUnions, BeyondTheBudgetPiecesAnswerAndItIsCounted) {
  UnionWorld world;
  world.bullet.world().setGravity(at(0, 0, 0));
  world.fixed(block(world, 6));
  const btRigidBody* body = world.moving(block(world, 5), at(.3, .2, .1), at(0, 0, 0));
  world.step(1);
  EXPECT_GT(world.solver.statistics().deep_unions_left, 0);
  EXPECT_TRUE(std::isfinite(static_cast<double>(body->getWorldTransform().getOrigin().length())));
}

/// A plate (a flat cylinder in a compound, with Bullet's default margin) that is spawned inside of a robot's arm of
/// boxes. @return the steps until it is no deeper than a millimetre
int steps_to_leave(bool ours, double x, double y, double z) {
  UnionWorld world(ours);
  world.bullet.world().setGravity(at(0, 0, 0));
  auto* arm = world.bullet.shape<btCompoundShape>();
  for (int i = 0; i < 3; ++i) {
    arm->addChildShape(btTransform(btQuaternion::getIdentity(), at(0, 0.2 * i, 0)),
                       world.bullet.shape<btBoxShape>(at(0.08, 0.12, 0.08)));
  }
  auto* disc = world.bullet.shape<btCylinderShape>(at(0.1, 0.0025, 0.1));
  disc->setMargin(btScalar(0.04));
  auto* plate = world.bullet.shape<btCompoundShape>();
  plate->addChildShape(btTransform::getIdentity(), disc);
  world.fixed(arm);
  world.moving(plate, at(x, y, z), at(0, 0, 0));
  for (int step = 1; step <= 240; ++step) {
    world.step();
    if (step == 1) {
      EXPECT_GT(world.bullet.num_contacts(), 0);
    }
    if (world.bullet.least_distance() > -1e-3) return step;
  }
  return 1000;
}

TEST(DeepUnions, APlateInsideOfARobotComesOutInBulletsTime) {
  for (const double x : {0.0, 0.02, 0.05}) {
    for (const double y : {0.17, 0.2, 0.45}) {
      const int bullet = steps_to_leave(false, x, y, 0.01), ours = steps_to_leave(true, x, y, 0.01);
      EXPECT_LE(ours, std::max(bullet, 10)) << x << ' ' << y;
    }
  }
}

enum class Thin { plate, disc, two_plates };

/// A thin body lies between two of eight flush boxes of a column, each of which pushes it into the other one.
/// @return the steps until no child is deeper than a millimetre
int steps_out_of_a_seam(Thin kind, double aside) {
  UnionWorld world;
  world.bullet.world().setGravity(at(0, 0, 0));
  auto* column = world.bullet.shape<btCompoundShape>();
  for (int i = 0; i < 8; ++i) {
    column->addChildShape(btTransform(btQuaternion::getIdentity(), at(0, 0.2 * i, 0)),
                          world.bullet.shape<btBoxShape>(at(0.09, 0.1, 0.12)));
  }
  btCollisionShape* thin = world.bullet.shape<btBoxShape>(at(0.1, 0.0025, 0.1));
  if (kind == Thin::disc) thin = world.bullet.shape<btCylinderShape>(at(0.1, 0.0025, 0.1));
  if (kind == Thin::two_plates) {
    auto* both = world.bullet.shape<btCompoundShape>();
    for (const double y : {-0.025, 0.025}) {
      both->addChildShape(btTransform(btQuaternion::getIdentity(), at(0, y, 0)), static_cast<btConvexShape*>(thin));
    }
    thin = both;
  }
  world.fixed(column);
  world.moving(thin, at(aside, 0.7, 0.01), at(0, 0, 0));
  for (int step = 1; step <= 240; ++step) {
    world.step();
    if (world.bullet.least_distance() > -1e-3) return step;
  }
  return 1000;
}

// With Bullet's contacts the bodies are still inside after 240 steps. From other places inside of such bodies they take
// up to 60 steps to come out.
TEST(DeepUnions, AThinBodyBetweenTwoChildrenComesOut) {
  for (const Thin kind : {Thin::plate, Thin::disc, Thin::two_plates}) {
    for (const double aside : {0.01, 0.05}) {
      EXPECT_LE(steps_out_of_a_seam(kind, aside), 60) << static_cast<int>(kind) << ' ' << aside;
    }
  }
}

}  // namespace
}  // namespace pd::test
