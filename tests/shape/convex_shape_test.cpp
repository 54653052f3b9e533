/// Factories of rounded and smooth shapes.
#include "pd/shape/convex_shape.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

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

std::vector<Sphere> chair() {
  return {{{1, 0, 0}, 0.5}, {{-1, 0, 0}, 0.25}, {{0, 1, 0}, 0.75}, {{0, 0, 1}, 0.375}, {{0, -2, -1}, 0.25}};
}

void expect_same(const ConvexShape& x, const ConvexShape& y) {
  EXPECT_EQ(x.margin(), y.margin());
  ASSERT_TRUE(std::holds_alternative<SphereHull>(x.core()) && std::holds_alternative<SphereHull>(y.core()));
  EXPECT_TRUE(std::get<SphereHull>(x.core()) == std::get<SphereHull>(y.core()));
}

TEST(HullOfSpheres, TheLeastRadiusIsAMargin) {
  const ConvexShape shape = *ConvexShape::hull_of_spheres(chair());
  EXPECT_EQ(shape.margin(), 0.25);
  const auto& core = std::get<SphereHull>(shape.core());
  ASSERT_EQ(core.spheres().size(), 5u);
  EXPECT_EQ(core.spheres()[0].centre, Vec3(-1, 0, 0));
  EXPECT_EQ(core.spheres()[0].radius, 0);
  for (int i = 0; i < 200; ++i) {
    const Vec3 d(std::sin(i), std::cos(7 * i), std::sin(3 * i + 1));
    double most = -HUGE_VAL;
    for (const Sphere& s : chair()) most = std::max(most, s.centre.dot(d) + s.radius * d.norm());
    EXPECT_NEAR(core.support(d).dot(d) + shape.margin() * d.norm(), most, 1e-14);
  }
  EXPECT_TRUE(core.support(Vec3::Zero()).allFinite());
}

TEST(HullOfSpheres, OrderRepetitionAndWhatLiesInsideDoNotMatter) {
  const ConvexShape plain = *ConvexShape::hull_of_spheres(chair());
  std::vector<Sphere> spheres = chair();
  std::reverse(spheres.begin(), spheres.end());
  spheres.push_back(spheres[2]);
  expect_same(*ConvexShape::hull_of_spheres(spheres), plain);
  spheres.push_back({{1.1, 0, 0}, 0.3});      // in one of the others
  spheres.push_back({{0.5, 0.5, 0}, 0.5});    // between two
  spheres.push_back({{0, 0.2, 0.1}, 0.125});  // among all, thinner than every other
  spheres.push_back({{0, 0.1, 0}, 0.7});      // among all, and in no ball that sums of the others give
  expect_same(*ConvexShape::hull_of_spheres(spheres), plain);
  // The least that stands out is another body.
  spheres.push_back({{1.5000001, 0, 0}, 0});
  EXPECT_EQ(ConvexShape::hull_of_spheres(spheres)->margin(), 0);
}

TEST(HullOfSpheres, SizesFarFromOneToo) {
  const ConvexShape plain = *ConvexShape::hull_of_spheres(chair());
  for (const int exponent : {-880, -300, 300, 890}) {
    std::vector<Sphere> spheres = chair();
    spheres.push_back({{0, 0.1, 0}, 0.7});
    for (Sphere& s : spheres) s = {std::ldexp(1, exponent) * s.centre, std::ldexp(s.radius, exponent)};
    const ConvexShape scaled = *ConvexShape::hull_of_spheres(spheres);
    EXPECT_EQ(scaled.margin(), std::ldexp(plain.margin(), exponent));
    EXPECT_EQ(std::get<SphereHull>(scaled.core()).spheres().size(), 5u) << exponent;
  }
}

TEST(HullOfSpheres, EqualRadiiAreAPolytopeWithAMargin) {
  std::vector<Sphere> spheres = chair();
  std::vector<Vec3> centres;
  for (Sphere& s : spheres) {
    s.radius = 0.3;
    centres.push_back(s.centre);
  }
  const ConvexShape shape = *ConvexShape::hull_of_spheres(spheres);
  ASSERT_NE(shape.polytope(), nullptr);
  EXPECT_EQ(shape.margin(), 0.3);
  EXPECT_EQ(shape.polytope()->num_vertices(), ConvexPolytope::from_points(centres)->num_vertices());
  // One that holds the others is all of it.
  spheres.push_back({{0, 0, 0}, 5});
  const ConvexShape ball = *ConvexShape::hull_of_spheres(spheres);
  ASSERT_NE(ball.polytope(), nullptr);
  EXPECT_EQ(ball.polytope()->num_vertices(), 1);
  EXPECT_EQ(ball.margin(), 5);
}

TEST(HullOfSpheres, RefusalsNameTheSphere) {
  const auto refusal = [](const Sphere& odd) {
    std::vector<Sphere> spheres = chair();
    spheres[3] = odd;
    return ConvexShape::hull_of_spheres(spheres).error();
  };
  EXPECT_EQ(ConvexShape::hull_of_spheres({}).error().code, ErrorCode::too_few_points);
  EXPECT_EQ(refusal({{0, 0, 0}, -1}).code, ErrorCode::bad_value);
  EXPECT_EQ(refusal({{0, 0, 0}, -1}).where, "spheres[3]");
  EXPECT_EQ(refusal({{0, kNaN, 0}, 1}).code, ErrorCode::non_finite);
  EXPECT_EQ(refusal({{0, 0, 0}, HUGE_VAL}).code, ErrorCode::non_finite);
  EXPECT_EQ(refusal({{0, 1e290, 0}, 1}).code, ErrorCode::out_of_range);
  const std::vector<Sphere> far{{{0, 0, 0}, 1}, {{1e301, 0, 0}, 1}};  // of equal radii, too
  EXPECT_EQ(ConvexShape::hull_of_spheres(far).error().code, ErrorCode::out_of_range);
  EXPECT_EQ(ConvexShape::hull_of_spheres(far).error().where, "spheres[1]");
}

TEST(ErrorCodes, AreTheProtocolsWords) {
  EXPECT_EQ(to_string(ErrorCode::bad_faces), "bad_faces");
  EXPECT_EQ(to_string(ErrorCode::not_full_dimensional), "not_full_dimensional");
  EXPECT_EQ(to_string(ErrorCode::limit_exceeded), "limit_exceeded");
}

}  // namespace
}  // namespace pd
