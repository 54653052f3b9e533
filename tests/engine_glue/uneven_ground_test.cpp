// Bodies come to rest on ground of many small triangles that is nowhere flat.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include "engine_glue/union_worlds.hpp"

namespace pd::test {
namespace {

btVector3 vector(double x, double y, double z) { return {btScalar(x), btScalar(y), btScalar(z)}; }

/// A bowl with waves, 6 m across.
btBvhTriangleMeshShape* waves(UnionWorld& world, double cell) {
  const int cells = static_cast<int>(6 / cell);
  const auto corner = [&](int i, int k) {
    const double x = cell * i - 3, z = cell * k - 3;
    return vector(x, .1 * (x * x + z * z) + .15 * std::sin(2 * x) * std::cos(2 * z), z);
  };
  std::vector<UnionWorld::Triangle> triangles;
  for (int i = 0; i < cells; ++i) {
    for (int k = 0; k < cells; ++k) {
      add_rectangle(triangles, corner(i, k), corner(i, k + 1), corner(i + 1, k + 1), corner(i + 1, k));
    }
  }
  return world.mesh(triangles, btScalar(CONVEX_DISTANCE_MARGIN));
}

/// The mean speed in the ninth second of a box that fell there turned and aside in the `start`th way.
double speed_after_a_fall(double cell, int start) {
  UnionWorld world;
  world.fixed(waves(world, cell))->setFriction(btScalar(.7));
  const btVector3 axis = vector(std::sin(1.7 * start), std::cos(2.3 * start), std::sin(.9 * start + 1)).normalized();
  const btTransform pose(btQuaternion(axis, btScalar(.8 * start)),
                         vector(1.4 * std::sin(5.1 * start), 1.2, 1.4 * std::cos(3.7 * start)));
  btRigidBody* body = world.moving(world.bullet.shape<btBoxShape>(vector(.25, .25, .25)), pose, vector(0, 0, 0));
  body->setFriction(btScalar(.7));
  body->setRollingFriction(btScalar(.02));
  body->setSpinningFriction(btScalar(.02));
  world.step(480);
  double sum = 0;
  for (int i = 0; i < 60; ++i) {
    world.step();
    sum += static_cast<double>(body->getLinearVelocity().length());
  }
  return sum / 60;
}

TEST(UnevenGround, BoxesComeToRest) {
  for (const double cell : {.1875, .5}) {
    std::vector<double> speeds;
    for (int start = 1; start <= 60; ++start) speeds.push_back(speed_after_a_fall(cell, start));
    std::sort(speeds.begin(), speeds.end());
    EXPECT_LT(speeds[44], 1e-3) << cell;  // three quarters
    EXPECT_LT(speeds[53], 3e-3) << cell;  // nine tenths
    EXPECT_LT(speeds[59], 0.02) << cell;
  }
}

/// A heightfield of bumps that are as high as they are wide, its quads split in both ways.
btHeightfieldTerrainShape* bumps(UnionWorld& world) {
  constexpr int kCorners = 25;
  world.heights.push_back(std::make_unique<std::vector<btScalar>>());
  for (int i = 0; i < kCorners * kCorners; ++i) {
    world.heights.back()->push_back(btScalar((i % kCorners * 7 + i / kCorners * 13) % 5) / 16);
  }
  auto* heights = world.bullet.shape<btHeightfieldTerrainShape>(kCorners, kCorners, world.heights.back()->data(),
                                                                btScalar(0), btScalar(0.25), 1, false);
  heights->setLocalScaling(vector(0.25, 1, 0.25));
  heights->setUseDiamondSubdivision(true);
  heights->setUseZigzagSubdivision(true);
  return heights;
}

// It sinks into a ridge by a little and is pushed out: it did not come from below.
TEST(UnevenGround, WhatIsPushedOutOfARidgeStaysAboveIt) {
  struct Start {
    bool cone;
    btQuaternion turn;
    double x, z;
  };
  const auto turned = [](double x, double y, double z, double w) {
    return btQuaternion(btScalar(x), btScalar(y), btScalar(z), btScalar(w));
  };
  const Start starts[] = {
      {true, turned(-0.0362502374, -0.0821750313, -0.0380589217, 0.995230973), -0.193411708, 1.16608667},
      {false, turned(-0.247982129, -0.475053519, 0.0517915003, 0.842702031), 1.90261173, -0.383168668},
      {false, turned(0.847792625, 0.451524466, -0.157241255, -0.229452491), -0.979365826, -0.115375891}};
  for (const Start& start : starts) {
    UnionWorld world;
    world.fixed(bumps(world))->setFriction(btScalar(0.5));
    btCollisionShape* shape = world.bullet.shape<btConeShape>(btScalar(0.2), btScalar(0.4));
    if (!start.cone) shape = world.bullet.shape<btCylinderShapeX>(vector(0.2, 0.2, 0.2));
    btRigidBody* body = world.moving(shape, btTransform(start.turn, vector(start.x, 0.8, start.z)), vector(0, 0, 0));
    body->setFriction(btScalar(0.5));
    for (int i = 0; i < 150; ++i) {
      world.step();
      ASSERT_GT(world.bullet.least_distance(), -0.2) << "step " << i << " of the start at " << start.x;
    }
    EXPECT_GT(static_cast<double>(body->getWorldTransform().getOrigin().y()), 0) << start.x;
  }
}

/// Numbers in [0, 1) that are the same with every library.
class Numbers {
 public:
  explicit Numbers(std::uint64_t seed) : state_(seed * 0x9E3779B97F4A7C15ULL + 1) {}
  double next() {
    state_ = state_ * 6364136223846793005ULL + 1442695040888963407ULL;
    return static_cast<double>(state_ >> 11U) * 0x1p-53;
  }
  double between(double low, double high) { return low + (high - low) * next(); }

 private:
  std::uint64_t state_;
};

/// A body tumbles over steep bumps. Returns the largest rise of the deepest contact in a step beyond what it came.
double most_sudden_depth(std::uint64_t seed) {
  constexpr int kCorners = 17;
  Numbers numbers(seed);
  UnionWorld world;
  const double cell = numbers.between(0.15, 0.5), high = cell * numbers.between(0.8, 1.6);
  world.heights.push_back(std::make_unique<std::vector<btScalar>>());
  for (int i = 0; i < kCorners * kCorners; ++i) {
    world.heights.back()->push_back(static_cast<btScalar>(numbers.between(0, high)));
  }
  auto* ground = world.bullet.shape<btHeightfieldTerrainShape>(kCorners, kCorners, world.heights.back()->data(),
                                                               btScalar(0), btScalar(high), 1, false);
  ground->setLocalScaling(vector(cell, 1, cell));
  world.fixed(ground)->setFriction(btScalar(0.5));
  const double size = numbers.between(0.08, 0.3);
  btCollisionShape* shape = world.bullet.shape<btBoxShape>(vector(size, size, size));
  if (seed % 2 == 0) {
    auto* hull = world.bullet.shape<btConvexHullShape>();
    const btVector3 corners[] = {vector(-1, -1, -1), vector(1, -1, -1), vector(0, -1, 1), vector(0, 1, 0)};
    for (const btVector3& corner : corners) hull->addPoint(btScalar(size) * corner);
    shape = hull;
  }
  const btVector3 at = vector(numbers.between(-5, 5) * cell, high + 2.5 * size, numbers.between(-5, 5) * cell);
  const btVector3 axis = vector(numbers.between(-1, 1), numbers.between(-1, 1), numbers.between(-1, 1)).normalized();
  btRigidBody* body = world.moving(shape, btTransform(btQuaternion(axis, btScalar(numbers.between(0, 6))), at),
                                   vector(numbers.between(-2, 2), numbers.between(-2, 0), numbers.between(-2, 2)));
  body->setFriction(btScalar(0.5));
  double last = 0, most = 0;
  for (int i = 0; i < 90; ++i) {
    const double way = static_cast<double>(body->getLinearVelocity().length()) +
                       2 * size * static_cast<double>(body->getAngularVelocity().length());
    world.step();
    const double depth = std::max(-world.bullet.least_distance(), 0.0);
    most = std::max(most, (depth - last - way / 30) / size);
    last = depth;
  }
  return most;
}

// A ridge's far slope has a plane that many bodies' middles are behind.
TEST(UnevenGround, NoContactOfBodiesThatTumbleIsSuddenlyDeep) {
  int sudden = 0;
  for (std::uint64_t seed = 0; seed < 250; ++seed) {
    if (most_sudden_depth(seed) > 0.2) ++sudden;
  }
  EXPECT_LE(sudden, 1);
}

}  // namespace
}  // namespace pd::test
