/// @file
/// Multispheres in Bullet worlds, of equal and unequal radii: where they come to rest, how quietly, and that no pair
/// goes to Bullet's solver.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "engine_glue/union_worlds.hpp"

namespace pd::test {
namespace {

constexpr btScalar kStep = btScalar(1) / 60;

btVector3 vector(double x, double y, double z) {
  return btVector3(static_cast<btScalar>(x), static_cast<btScalar>(y), static_cast<btScalar>(z));
}

/// Three feet that all reach down to y = -0.5, and a head. The centre of mass is above their triangle.
btMultiSphereShape* tripod(BulletWorld& scene, bool equal_radii) {
  std::array<btVector3, 4> centres;
  std::array<btScalar, 4> radii;
  for (std::size_t i = 0; i < 4; ++i) {
    const double radius = equal_radii ? 0.2 : std::array{0.3, 0.1, 0.2, 0.25}[i];
    const double x = std::array{0.5, -0.5, -0.5, 0.0}[i], z = std::array{0.0, 0.4, -0.4, 0.0}[i];
    centres[i] = vector(x, i == 3 ? 0.2 : radius - 0.5, z);
    radii[i] = static_cast<btScalar>(radius);
  }
  return scene.shape<btMultiSphereShape>(centres.data(), radii.data(), 4);
}

enum class Ground { plane, box, mesh, tiles, hull };
constexpr std::array kGrounds{Ground::plane, Ground::box, Ground::mesh, Ground::tiles, Ground::hull};
constexpr const char* kNames[] = {"plane", "box", "mesh", "tiles", "hull"};

/// A level floor at y = 0.
void add_ground(UnionWorld& world, Ground kind) {
  BulletWorld& scene = world.bullet;
  switch (kind) {
    case Ground::plane:
      scene.body(scene.shape<btStaticPlaneShape>(vector(0, 1, 0), btScalar(0)), 0, vector(0, 0, 0));
      return;
    case Ground::box:
      scene.body(scene.shape<btBoxShape>(vector(10, 1, 10)), 0, vector(0, -1, 0));
      return;
    case Ground::hull:
      scene.body(box_hull(scene, vector(5, 1, 5), btScalar(0.04)), 0, vector(0, -1.04, 0));
      return;
    case Ground::mesh: {
      std::vector<UnionWorld::Triangle> triangles;
      add_floor(triangles, -4, 4, -4, 4, 8, 8);
      scene.body(world.mesh(triangles, 0), 0, vector(0, 0, 0));
      return;
    }
    case Ground::tiles: {
      auto* tiles = scene.shape<btCompoundShape>();
      auto* tile = scene.shape<btBoxShape>(vector(0.5, 0.5, 0.5));
      for (int x = -4; x < 4; ++x) {
        for (int z = -4; z < 4; ++z) {
          tiles->addChildShape(btTransform(btQuaternion::getIdentity(), vector(x + 0.5, -0.5, z + 0.5)), tile);
        }
      }
      scene.body(tiles, 0, vector(0, 0, 0));
      return;
    }
  }
}

struct Rest {
  double height, tilt, speed, deepest;
  int contacts;
  std::int64_t unsupported;
};

/// After four seconds from a fall of 2 cm.
Rest rest_on(Ground ground, bool ours, bool equal_radii) {
  UnionWorld world(ours);
  add_ground(world, ground);
  btRigidBody* body = world.bullet.body(tripod(world.bullet, equal_radii), 1, vector(0.1, 0.52, 0.07));
  body->setSleepingThresholds(0, 0);
  double deepest = 0;
  for (int i = 0; i < 240; ++i) {
    world.bullet.world().stepSimulation(kStep, 0);
    deepest = std::min(deepest, world.bullet.least_distance());
  }
  const btTransform& pose = body->getWorldTransform();
  return {static_cast<double>(pose.getOrigin().y()),
          std::acos(std::min(1.0, static_cast<double>(pose.getBasis()[1].y()))),
          static_cast<double>(body->getLinearVelocity().length()),
          -deepest,
          world.bullet.num_contacts(),
          world.solver.statistics().unsupported};
}

TEST(Multispheres, RestOnAnyGroundAsTheirRadiiSay) {
  for (const bool equal_radii : {true, false}) {
    for (const Ground ground : kGrounds) {
      const std::string name = kNames[static_cast<std::size_t>(ground)];
      const Rest bullet = rest_on(ground, false, equal_radii), ours = rest_on(ground, true, equal_radii);
      std::printf("%s radii on a %s: Bullet %.4f (%.4f deep, %.1e m/s, %d points), ours %.4f (%.4f, %.1e, %d)\n",
                  equal_radii ? "equal" : "unequal", name.c_str(), bullet.height, bullet.deepest, bullet.speed,
                  bullet.contacts, ours.height, ours.deepest, ours.speed, ours.contacts);
      EXPECT_EQ(ours.unsupported, 0) << name;
      EXPECT_NEAR(ours.height, 0.5, 0.003) << name;
      EXPECT_LT(ours.tilt, 0.005) << name;
      EXPECT_LT(ours.speed, 1e-3) << name;
      EXPECT_LE(ours.deepest, bullet.deepest) << name;
      EXPECT_GE(ours.contacts, 3) << name;
      if (ground == Ground::plane) continue;  // by Bullet's own algorithm
      EXPECT_LT(ours.deepest, 1e-4) << name;
    }
  }
}

/// Against each other and against every other convex shape, thrown together: nobody is lost, nobody deep in anybody.
TEST(Multispheres, HeapOfThemStaysOnTheFloor) {
  UnionWorld world(true);
  BulletWorld& scene = world.bullet;
  add_ground(world, Ground::mesh);
  for (const auto& [x, z] : {std::pair{2.5, 0.0}, std::pair{-2.5, 0.0}}) {
    scene.body(scene.shape<btBoxShape>(vector(0.2, 2, 3)), 0, vector(x, 2, z));
    scene.body(scene.shape<btBoxShape>(vector(3, 2, 0.2)), 0, vector(z, 2, x));
  }
  std::vector<btRigidBody*> bodies;
  for (int i = 0; i < 16; ++i) {
    btCollisionShape* shape = tripod(scene, i % 3 == 0);
    if (i % 4 == 1) shape = scene.shape<btCylinderShape>(vector(0.3, 0.4, 0.3));
    if (i % 4 == 3) shape = scene.shape<btCapsuleShape>(btScalar(0.25), btScalar(0.6));
    const btQuaternion turn(static_cast<btScalar>(i), static_cast<btScalar>(2 * i), static_cast<btScalar>(3 * i));
    const btVector3 at = vector(1.2 * ((i % 3) - 1), 0.8 + 0.5 * i, 1.2 * ((i / 3) % 3 - 1));
    bodies.push_back(scene.body(shape, 1, btTransform(turn, at)));
  }
  for (int i = 0; i < 480; ++i) scene.world().stepSimulation(kStep, 0);
  EXPECT_EQ(world.solver.statistics().unsupported, 0);
  for (const btRigidBody* body : bodies) {
    EXPECT_GT(static_cast<double>(body->getWorldTransform().getOrigin().y()), 0.15);
    EXPECT_LT(static_cast<double>(body->getLinearVelocity().length()), 1);
  }
  EXPECT_GT(scene.least_distance(), -0.03);
}

/// A child of a compound lies on the floor as it does by itself.
TEST(Multispheres, AsChildOfACompound) {
  UnionWorld world(true);
  BulletWorld& scene = world.bullet;
  add_ground(world, Ground::mesh);
  auto* compound = scene.shape<btCompoundShape>();
  compound->addChildShape(btTransform::getIdentity(), tripod(scene, false));
  compound->addChildShape(btTransform(btQuaternion::getIdentity(), vector(0, 0.4, 0)),
                          scene.shape<btBoxShape>(vector(0.2, 0.2, 0.2)));
  const btRigidBody* body = scene.body(compound, 1, vector(0, 0.52, 0));
  for (int i = 0; i < 240; ++i) scene.world().stepSimulation(kStep, 0);
  EXPECT_NEAR(static_cast<double>(body->getWorldTransform().getOrigin().y()), 0.5, 0.003);
  EXPECT_EQ(world.solver.statistics().unsupported, 0);
}

}  // namespace
}  // namespace pd::test
