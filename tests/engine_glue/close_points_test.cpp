/// @file
/// Contact points nearer to each other than the breaking threshold, within which Bullet takes two points for one.

#include <gtest/gtest.h>

#include <cmath>

#include "bullet_world.hpp"
#include "pd/bullet/install.hpp"
#include "pd/bullet/penetration_depth_solver.hpp"

namespace pd::test {
namespace {

// The tip, a square of 12 mm, lies whole within the threshold of 2 cm: whichever corner comes last, the deepest counts.
TEST(ClosePoints, TheDeepestOfAPointedFootIsKept) {
  constexpr btScalar kTip = btScalar(0.006);
  constexpr double kDepth = 0.004;
  for (int turn = 0; turn < 16; ++turn) {
    for (const int steps : {1, 3}) {
      SCOPED_TRACE(turn);
      BulletWorld world;
      BulletPenetrationDepthSolver solver;
      install(world.dispatcher(), solver);
      world.body(world.shape<btBoxShape>(btVector3(2, 1, 2)), 0, btVector3(0, -1, 0));
      auto* foot = world.shape<btConvexHullShape>();
      foot->setMargin(0);
      for (int i = 0; i < 8; ++i) {
        const btScalar half = (i & 1) != 0 ? btScalar(0.8) : kTip;
        foot->addPoint(btVector3((i & 2) != 0 ? half : -half, btScalar(i & 1), (i & 4) != 0 ? half : -half));
      }
      const auto angle = static_cast<btScalar>(0.3927 * turn);
      const btQuaternion lean(btVector3(std::cos(angle), 0, std::sin(angle)), btScalar(0.1));
      btScalar lowest = 0;
      for (int i = 0; i < 8; ++i) lowest = std::min(lowest, quatRotate(lean, foot->getScaledPoint(i)).y());
      world.body(foot, 1, btTransform(lean, btVector3(0, -lowest - static_cast<btScalar>(kDepth), 0)));
      for (int i = 0; i < steps; ++i) world.world().performDiscreteCollisionDetection();
      EXPECT_GT(world.num_contacts(), 1);
      EXPECT_NEAR(world.least_distance(), -kDepth, 1e-6);
    }
  }
}

}  // namespace
}  // namespace pd::test
