/// @file
/// Gentle triangles, answered without queries: the nearest triangle of all, which nothing covers, says what a query
/// says.
#include <BulletCollision/CollisionShapes/btTriangleShape.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "engine_glue/union_worlds.hpp"
#include "pd/bullet/scalar.hpp"
#include "pd/bullet/shape_conversion.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "scenes/shape_families.hpp"

namespace pd::test {
namespace {

constexpr btScalar kMargin = btScalar(.01);

std::vector<UnionWorld::Triangle> waves(int cells, double steepness) {
  const auto corner = [&](int i, int k) {
    const double x = 4.0 * i / cells - 2, z = 4.0 * k / cells - 2;
    const double height = steepness * std::sin(2 * x) * std::cos(2 * z);
    return btVector3(static_cast<btScalar>(x), static_cast<btScalar>(height), static_cast<btScalar>(z));
  };
  std::vector<UnionWorld::Triangle> triangles;
  for (int i = 0; i < cells; ++i) {
    for (int k = 0; k < cells; ++k) {
      add_rectangle(triangles, corner(i, k), corner(i, k + 1), corner(i + 1, k + 1), corner(i + 1, k));
    }
  }
  return triangles;
}

/// Of the body from all triangles, by queries.
double distance_from(const std::vector<UnionWorld::Triangle>& triangles, const btConvexShape& body,
                     const btTransform& pose) {
  Scratch scratch;
  DepthSettings settings;
  settings.bracket = Bracket::tightest;
  const auto shape = to_convex_shape(body);
  double least = 1e30;
  for (const UnionWorld::Triangle& triangle : triangles) {
    btTriangleShape flat(triangle[0], triangle[1], triangle[2]);
    flat.setMargin(kMargin);
    const auto other = to_convex_shape(flat);
    const PenetrationDepth answer =
        penetration_depth({&*shape, to_pd(pose)}, {&*other, to_pd(btTransform::getIdentity())}, scratch, settings);
    least = std::min(least, answer.signed_distance());
  }
  return least;
}

TEST(GentleGround, TheNearestTriangleSaysWhatAQuerySays) {
  scenes::Random random(20261126);
  for (const double steepness : {0.0, .01, .05, .1}) {
    const std::vector<UnionWorld::Triangle> triangles = waves(20, steepness);
    for (int i = 0; i < 18; ++i) {
      UnionWorld world;
      world.fixed(world.mesh(triangles, kMargin));
      btConvexShape* body = world.bullet.shape<btBoxShape>(btVector3(btScalar(.3), btScalar(.2), btScalar(.25)));
      if (i % 3 == 2) body = world.bullet.shape<btSphereShape>(btScalar(.25));
      // Every other one nearly level, so that faces, edges and corners of both are met.
      const double turned = i % 2 == 0 ? .05 : 1;
      const auto q = random.quaternion();
      const btQuaternion turn(static_cast<btScalar>(turned * q[1]), static_cast<btScalar>(turned * q[2]),
                              static_cast<btScalar>(turned * q[3]), static_cast<btScalar>(q[0]));
      btTransform pose(turn.normalized(), to_bullet(Vec3(random.point(-1, 1))));
      pose.getOrigin().setY(1);
      double distance = 0;
      // Lowered until its gap is a few millimetres: each way down is at most the gap.
      for (int k = 0; k < 40; ++k) {
        distance = distance_from(triangles, *body, pose);
        if (distance < .005) break;
        pose.getOrigin().setY(pose.getOrigin().y() - static_cast<btScalar>(distance - .003));
      }
      world.moving(body, pose, btVector3(0, 0, 0));
      world.bullet.world().performDiscreteCollisionDetection();
      EXPECT_NEAR(world.bullet.least_distance(), distance, 2e-6) << steepness << ' ' << i;
      // No triangle was asked by a query that could remember it.
      EXPECT_EQ(world.solver.statistics().warm, 0) << steepness << ' ' << i;
      world.bullet.world().performDiscreteCollisionDetection();
      EXPECT_EQ(world.solver.statistics().warm, 0) << steepness << ' ' << i;
    }
  }
}

/// On the ridge of a roof, of triangles of any size: what is not gentle is asked as ever.
TEST(GentleGround, ASteepEdgeIsAskedByQueries) {
  const auto at = [](double x, double y, double z) {
    return btVector3(static_cast<btScalar>(x), static_cast<btScalar>(y), static_cast<btScalar>(z));
  };
  for (const double slope : {.1, .5}) {
    for (const double cell : {2.0, .1}) {
      UnionWorld world;
      std::vector<UnionWorld::Triangle> triangles;
      for (double z = -1; z < .99; z += cell) {
        add_rectangle(triangles, at(-cell, -slope * cell, z), at(-cell, -slope * cell, z + cell), at(0, 0, z + cell),
                      at(0, 0, z));
        add_rectangle(triangles, at(0, 0, z), at(0, 0, z + cell), at(cell, -slope * cell, z + cell),
                      at(cell, -slope * cell, z));
      }
      world.fixed(world.mesh(triangles, kMargin));
      auto* box = world.bullet.shape<btBoxShape>(at(.05, .2, .05));
      world.moving(box, at(0, .2 + .01 + .001, .02), at(0, 0, 0));
      world.bullet.world().performDiscreteCollisionDetection();
      world.bullet.world().performDiscreteCollisionDetection();
      EXPECT_EQ(world.solver.statistics().warm > 0, slope > .3) << slope << ' ' << cell;
      EXPECT_NEAR(world.bullet.least_distance(), .001, 1e-6) << slope << ' ' << cell;
    }
  }
}

}  // namespace
}  // namespace pd::test
