/// Factories of rounded and smooth shapes.
#include "pd/shape/convex_shape.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace pd {
namespace {

const double kNaN = std::numeric_limits<double>::quiet_NaN();

TEST(ConvexShape, SphereIsAPointWithAMargin) {
  const auto sphere = ConvexShape::sphere(2);
  ASSERT_TRUE(sphere.has_value());
  EXPECT_EQ(sphere->margin(), 2);
  ASSERT_NE(sphere->polytope(), nullptr);
  EXPECT_EQ(sphere->polytope()->affine_dimension(), 0);
}

TEST(ConvexShape, CapsuleIsASegmentWithAMargin) {
  for (int axis = 0; axis < 3; ++axis) {
    const auto capsule = ConvexShape::capsule(0.5, 2, axis);
    ASSERT_TRUE(capsule.has_value());
    ASSERT_NE(capsule->polytope(), nullptr);
    EXPECT_EQ(capsule->polytope()->affine_dimension(), 1);
    EXPECT_EQ(capsule->polytope()->vertex(0)[axis], -2);
    EXPECT_EQ(capsule->polytope()->vertex(1)[axis], 2);
    EXPECT_EQ(capsule->margin(), 0.5);
  }
  EXPECT_EQ(ConvexShape::capsule(0.5, 0, 1)->polytope()->affine_dimension(), 0);
}

TEST(ConvexShape, SmoothCores) {
  EXPECT_EQ(ConvexShape::ellipsoid({1, 2, 3})->polytope(), nullptr);
  EXPECT_EQ(std::get<Cylinder>(ConvexShape::cylinder(1, 2, 1)->core()).axis, 1);
  EXPECT_EQ(std::get<Cone>(ConvexShape::cone(1, 2, 2)->core()).half_height, 2);
}

TEST(ConvexShape, Margins) {
  const auto rounded = ConvexShape(*ConvexPolytope::box({1, 1, 1})).with_margin(0.25);
  ASSERT_TRUE(rounded.has_value());
  EXPECT_EQ(rounded->with_margin(0.5)->margin(), 0.75);
  EXPECT_EQ(rounded->with_margin(-1).error().code, ErrorCode::bad_value);
  EXPECT_EQ(rounded->with_margin(kNaN).error().code, ErrorCode::non_finite);
  EXPECT_EQ(rounded->with_margin(2e300).error().code, ErrorCode::out_of_range);
}

TEST(ConvexShape, RefusalsNameTheParameter) {
  EXPECT_EQ(ConvexShape::sphere(0).error().code, ErrorCode::bad_value);
  EXPECT_EQ(ConvexShape::sphere(0).error().where, "radius");
  EXPECT_EQ(ConvexShape::sphere(HUGE_VAL).error().code, ErrorCode::non_finite);
  EXPECT_EQ(ConvexShape::sphere(1e301).error().code, ErrorCode::out_of_range);
  EXPECT_EQ(ConvexShape::ellipsoid({1, -1, 1}).error().where, "radii[1]");
  EXPECT_EQ(ConvexShape::cylinder(1, 0, 0).error().where, "half_height");
  EXPECT_EQ(ConvexShape::cone(1, 1, 3).error().where, "axis");
  EXPECT_EQ(ConvexShape::capsule(1, -1, 0).error().code, ErrorCode::bad_value);
}

TEST(ErrorCodes, AreTheProtocolsWords) {
  EXPECT_EQ(to_string(ErrorCode::bad_faces), "bad_faces");
  EXPECT_EQ(to_string(ErrorCode::not_full_dimensional), "not_full_dimensional");
  EXPECT_EQ(to_string(ErrorCode::limit_exceeded), "limit_exceeded");
}

}  // namespace
}  // namespace pd
