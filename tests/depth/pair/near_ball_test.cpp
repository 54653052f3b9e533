/// @file
/// Ellipsoids of equal and nearly equal radii: directions tied on the whole sphere, on circles and in opposite pairs
/// are answered in a bounded number of supports; the depth of a point in an ellipsoid in closed form.

#include <gtest/gtest.h>

#include <cmath>

#include "depth/difference/smooth_difference.hpp"
#include "depth/features/point_in_ellipsoid.hpp"
#include "oracle/curved_oracle.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "pd/depth/warm_certificate.hpp"
#include "scenes/shape_families.hpp"

namespace pd {
namespace {

using scenes::Random;

Vec3 point_of_surface(const Vec3& radii, const Vec3& direction) {
  return direction / direction.cwiseQuotient(radii).norm();
}

/// The ball of the answer's radius lies in the ellipsoid, and the point outwards of it lies on the surface at that
/// distance: each is a proof of one side.
void expect_nearest(const Vec3& radii, const Vec3& point, Random& random) {
  const detail::PointInEllipsoid found = detail::point_in_ellipsoid(radii, point);
  SCOPED_TRACE(::testing::Message() << "radii " << radii.transpose() << ", point " << point.transpose());
  const Vec3 unit = found.outward.normalized();
  // The height of the supporting plane above the point bounds its depth from above.
  const double height = radii.cwiseProduct(unit).norm() - point.dot(unit);
  EXPECT_LE(found.lower, height * (1 + 1e-15));
  EXPECT_GE(found.lower, height - 1e-13 * radii.maxCoeff());
  for (int k = 0; k < 200; ++k) {
    const Vec3 direction = k % 2 == 0 ? random.direction() : Vec3(unit + 0.02 * random.direction());
    EXPECT_GE((point_of_surface(radii, direction) - point).norm(), found.lower);
  }
}

TEST(NearBall, PointInEllipsoidIsNearestToItsFoot) {
  Random random(5);
  for (int i = 0; i < 400; ++i) {
    const double spread = std::pow(10.0, -(i % 8));
    const Vec3 radii = Vec3::Ones() + spread * random.point(0, 1);
    Vec3 point = random.vector(0, 0.95);
    if (i % 5 == 1) point[i % 3] = 0;
    if (i % 5 == 2) point = Vec3::Zero();
    if (i % 5 == 3) point = Vec3::Unit(i % 3) * random.uniform(0, 0.9);
    expect_nearest(radii, point, random);
  }
  // Equal shortest axes; the hard case is left at r_2 (1 - r_0^2 / r_2^2).
  expect_nearest({1, 1, 1}, {0, 0, 0}, random);
  expect_nearest({1, 1, 1}, {0.3, 0.2, 0.1}, random);
  expect_nearest({1, 1, 2}, {0, 0, 1.4}, random);
  expect_nearest({1, 1, 2}, {0, 0, 1.6}, random);
  expect_nearest({1, 1, 2}, {1e-9, 0, 1.4}, random);
  expect_nearest({0.01, 1, 2}, {0.002, 0.3, 0.4}, random);
}

ConvexShape small_body(int kind, double spread, Random& random) {
  const Vec3 origin = Vec3::Zero();
  switch (kind) {
    case 0:
      return *ConvexPolytope::from_points({&origin, 1});
    case 1:
      return *ConvexShape::sphere(0.1);
    case 2:
      return *ConvexShape::ellipsoid(0.1 * (Vec3::Ones() + spread * random.point(0, 1)));
    case 3:
      return *ConvexPolytope::box({0.1, 0.12, 0.14});
    case 4:
      return *ConvexShape::capsule(0.1, 0.1, 1);
    default:
      return *ConvexShape::ellipsoid({0.1, 0.15, 0.2});
  }
}

/// Every support bounds the depth from above, so none may lie below the lower bound; the answer's own proves the upper.
TEST(NearBall, SmallBodiesInsideAreAnsweredInFewSupports) {
  Random random(11);
  Scratch scratch;
  std::int64_t most = 0;
  for (const double spread : {0.0, 1e-9, 1e-7, 1e-5, 1e-3, 1e-2, 1e-1}) {
    for (int i = 0; i < 120; ++i) {
      const int kind = i % 6;
      const ConvexShape a = *ConvexShape::ellipsoid(Vec3::Ones() + spread * random.point(0, 1));
      const ConvexShape b = small_body(kind, spread, random);
      const Vec3 centre(0.1, 0.2, 0.3);
      const double apart = i % 4 == 0 ? 0 : i % 4 == 1 ? random.uniform(0, 0.3) : random.uniform(0.3, 1);
      const PosedShape posed_a{&a, random.pose(centre)};
      const PosedShape posed_b{&b, random.pose(centre + apart * random.direction())};
      SCOPED_TRACE(::testing::Message() << "spread " << spread << ", pair " << i);
      // Either order, so that both sides of the difference have been the near-ball.
      const PenetrationDepth d = i % 2 == 0 ? penetration_depth(posed_a, posed_b, scratch, {.delta = 1e-6})
                                            : penetration_depth(posed_b, posed_a, scratch, {.delta = 1e-6});
      const PosedShape &first = i % 2 == 0 ? posed_a : posed_b, &second = i % 2 == 0 ? posed_b : posed_a;
      ASSERT_EQ(d.contact, ContactClass::overlapping);
      EXPECT_TRUE(d.bracket_reached);
      EXPECT_LE(d.upper, d.lower * (1 + 1.01e-6));
      const auto height = [&](const Vec3& unit) {
        return static_cast<double>(oracle::difference_support(first, second, unit));
      };
      EXPECT_LE(height(d.normal), d.upper * (1 + 1e-15));
      for (int k = 0; k < 100; ++k) {
        const Vec3 near = (d.normal + std::pow(10.0, -(k % 6)) * random.direction()).normalized();
        EXPECT_GE(height(near), d.lower * (1 - 1e-15));
      }
      EXPECT_LE((d.witness_b - d.witness_a - d.translation).norm(), 1e-12);
      most = std::max(most, d.statistics.support_calls);
    }
  }
  std::printf("at most %lld supports\n", static_cast<long long>(most));
  EXPECT_LE(most, 400);
}

/// Memory, margins and distances with the rolling balls taken out: the same brackets around the same numbers.
TEST(NearBall, ApartAndTouching) {
  Scratch scratch;
  const ConvexShape a = *ConvexShape::ellipsoid({1, 1, 1}),
                    b = *ConvexShape::ellipsoid({0.5, 0.5, 0.5})->with_margin(0.25);
  WarmCertificate memory;
  for (const double distance : {3.0, 1.75 + 1e-3, 1.75 + 1e-9, 1.75, 1.75 - 1e-9, 1.75 - 1e-3, 1.0}) {
    const PenetrationDepth d = penetration_depth(
        {&a, Pose()}, {&b, *Pose::from_matrix(Mat3::Identity(), {distance, 0, 0})}, scratch, {.delta = 1e-6}, &memory);
    SCOPED_TRACE(distance);
    const double signed_distance = distance - 1.75;
    EXPECT_NEAR(d.signed_distance(), signed_distance, 1e-12 + 1e-6 * std::abs(signed_distance));
    if (std::abs(signed_distance) > 1e-11) {
      EXPECT_EQ(d.contact, signed_distance > 0 ? ContactClass::separated : ContactClass::overlapping);
    } else {
      EXPECT_EQ(d.contact, ContactClass::touching);
    }
    EXPECT_NEAR(d.witness_a.x(), 1, 1e-6);
    EXPECT_NEAR(d.witness_b.x(), distance - 0.75, 1e-6);
  }
}

}  // namespace
}  // namespace pd
