// A body that is proved to stay apart from a triangle does so at every time that is looked at.
#include "pd/contact/stays_apart.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"

namespace pd::test {
namespace {

class Motions {
 public:
  double number() { return 2 * std::generate_canonical<double, 53>(random_) - 1; }
  Vec3 vector() {
    const double x = number(), y = number();
    return {x, y, number()};
  }
  MovingShape moving(const ConvexShape& shape) {
    MovingShape body;
    body.start = {&shape, Pose::from_trusted_matrix(Mat3::Identity(), vector())};
    body.motion = {2 * vector(), 3 * vector()};
    body.arm = 0.3 * vector();
    return body;
  }

 private:
  std::mt19937_64 random_{7};
};

TEST(StaysApart, WhatIsProvedHolds) {
  Motions random;
  Scratch scratch;
  std::vector<Vec3> points;
  for (int i = 0; i < 12; ++i) points.push_back(0.4 * random.vector());
  const ConvexShape shapes[] = {ConvexShape(*ConvexPolytope::box({0.3, 0.2, 0.4})),
                                *ConvexShape(*ConvexPolytope::from_points(points)).with_margin(0.05),
                                *ConvexShape::cylinder(0.2, 0.4, 1), *ConvexShape::cone(0.3, 0.3, 2)};
  int along = 0, beside = 0;
  for (int trial = 0; trial < 400; ++trial) {
    SCOPED_TRACE(trial);
    const MovingShape body = random.moving(shapes[trial % 4]);
    const Vec3 middle = 2 * random.vector();
    const StillTriangle triangle{{middle + random.vector(), middle + random.vector(), middle + random.vector()}, 0.01};
    const auto shape = ConvexShape(*ConvexPolytope::from_points(triangle.corners)).with_margin(triangle.margin);
    const auto& corners = triangle.corners;
    Vec3 n = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalized();
    if (n.dot(body.start.pose.translation() - corners[0]) < 0) n = -n;
    const SupportLevel level{n, n.dot(corners[0]) + triangle.margin};
    const double duration = 0.2;
    const auto distance_at = [&](double time) {
      const PosedShape then{body.start.shape, pose_at(body, time)};
      return penetration_depth(then, {&*shape, Pose()}, scratch).signed_distance();
    };
    StaysApart proofs(body, duration);
    // No direction says more than the distance does.
    EXPECT_LE(proofs.at_start(level), distance_at(0) + 1e-9);
    EXPECT_LE(proofs.beside_at_start(triangle), distance_at(0) + 1e-9);
    EXPECT_NEAR(n.dot(proofs.first_along(n)) - body.start.shape->margin() - level.level, proofs.at_start(level), 1e-9);
    const double least = 0.01;
    const bool apart_along = proofs.proved(level, least), apart_beside = proofs.proved_beside(triangle, least);
    along += apart_along ? 1 : 0;
    beside += apart_beside ? 1 : 0;
    if (!apart_along && !apart_beside) continue;
    for (int k = 0; k <= 20; ++k) EXPECT_GE(distance_at(duration * k / 20), least - 1e-9) << k;
  }
  EXPECT_GT(along, 50);
  EXPECT_GT(beside, 50);
}

// Half a turn within the duration: both ends are apart, and the body comes near in between.
TEST(StaysApart, EndsDoNotProveATurn) {
  const ConvexShape rod(*ConvexPolytope::box({1, 0.05, 0.05}));
  MovingShape body;
  body.start = {&rod, Pose()};
  body.motion.angular_velocity = Vec3(0, std::acos(-1.0), 0);
  StaysApart proofs(body, 1);
  const SupportLevel below{Vec3(0, 0, 1), -0.5};
  EXPECT_GT(proofs.at_start(below), 0.4);
  EXPECT_FALSE(proofs.proved(below, 0));
  EXPECT_TRUE(proofs.proved({Vec3(0, 0, 1), -1.2}, 0));
}

}  // namespace
}  // namespace pd::test
