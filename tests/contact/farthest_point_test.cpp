// Farthest points in doubles reach as far as the exact support says.
#include "pd/contact/farthest_point.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>
#include <vector>

#include "pd/contact/time_of_impact.hpp"
#include "pd/depth/difference_queries.hpp"

namespace pd::test {
namespace {

TEST(FarthestPoint, ReachesAsFarAsTheExactSupport) {
  std::mt19937_64 random(5);
  const auto number = [&] { return 2 * std::generate_canonical<double, 53>(random) - 1; };
  const auto vector = [&] {
    const double x = number(), y = number();
    return Vec3(x, y, number());
  };
  std::vector<Vec3> points;
  for (int i = 0; i < 20; ++i) points.push_back(vector());
  const ConvexShape shapes[] = {ConvexShape(*ConvexPolytope::box({0.3, 0.2, 0.4})),
                                *ConvexShape(*ConvexPolytope::from_points(points)).with_margin(0.05),
                                *ConvexShape::cylinder(0.2, 0.4, 1),
                                *ConvexShape::cone(0.3, 0.3, 2),
                                *ConvexShape::ellipsoid({0.3, 0.1, 0.2}),
                                *ConvexShape::hull_of_spheres(std::vector<Sphere>{{{0, 0, 0}, 0.1}, {{1, 0, 0}, 0.2}})};
  for (const ConvexShape& a : shapes) {
    for (const ConvexShape& b : shapes) {
      for (int trial = 0; trial < 20; ++trial) {
        const auto pose = [&] {
          const Mat3 turned = Eigen::AngleAxisd(3 * number(), vector().normalized()).toRotationMatrix();
          return Pose::from_trusted_matrix(turned, 10 * vector());
        };
        const PosedShape posed_a{&a, pose()}, posed_b{&b, pose()};
        // Facet normals tie all corners of the facet.
        const Vec3 n = trial % 2 == 0 ? vector().normalized() : Vec3(posed_a.pose.rotation().col(trial % 3));
        EXPECT_NEAR(reach_along(posed_a, posed_b, n), support_of_difference(posed_a, posed_b, n)->value, 1e-13 * 40);
        const Vec3 local =
            posed_a.pose.rotation().transpose() * (farthest_point(posed_a, n) - posed_a.pose.translation());
        EXPECT_LT(local.norm(), bounding_radius(a) + 1e-12);
      }
    }
  }
}

TEST(FarthestPoint, AlongTheShortestAndTheLongestDirections) {
  const ConvexShape shapes[] = {*ConvexShape::ellipsoid({1, 2, 3}), *ConvexShape::cylinder(1, 2, 2),
                                *ConvexShape::cone(1, 2, 0)};
  for (const ConvexShape& shape : shapes) {
    const Vec3 expected = farthest_point({&shape, Pose()}, {1, 1, 1});
    for (const double length : {5e-324, 1e-310, 1e-200, 1e200, 1e308}) {
      const Vec3 found = farthest_point({&shape, Pose()}, {length, length, length});
      EXPECT_LT((found - expected).norm(), 1e-12) << length;
    }
  }
}

}  // namespace
}  // namespace pd::test
