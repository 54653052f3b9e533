/// @file
/// Approximate widths: of polytopes by rays over half the sphere, of many points by a kernel; (1 + delta) never broken.
#include "pd/depth/approximate_width.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "pd/depth/scratch.hpp"
#include "pd/depth/width.hpp"
#include "scenes/shape_families.hpp"

namespace pd {
namespace {

struct Body {
  const char* name;
  std::vector<Vec3> points;
};

std::vector<Body> bodies() {
  scenes::Random random(50);
  std::vector<Body> bodies;
  for (const int n : {4, 10, 40, 200}) bodies.push_back({"sphere", scenes::sphere_hull(n, random)});
  bodies.push_back({"needle", scenes::needle(60, random)});
  bodies.push_back({"prism", scenes::prism(40)});
  bodies.push_back({"lens", scenes::lens(40, 0.5)});
  bodies.push_back({"roof", scenes::roof(40, {}, random)});
  bodies.push_back({"box", scenes::box(Vec3(3, 1, 2))});
  bodies.push_back({"sliver", scenes::sliver(30, 1e-3, random)});
  bodies.push_back({"cloud", scenes::cloud(80, random)});
  bodies.push_back({"integers", scenes::integer_points(60, 5, random)});
  return bodies;
}

TEST(ApproximateWidth, GridKeepsItsFactor) {
  Scratch scratch;
  scenes::Random random(51);
  for (const Body& body : bodies()) {
    const ConvexShape shape(*ConvexPolytope::from_points(body.points));
    const PosedShape posed{&shape, random.pose(random.direction())};
    const Width exact = width(posed, scratch);
    for (const double delta : {1.0, 0.1, 1e-2, 1e-4, 1e-6}) {
      const Width grid = width(posed, scratch, Method::grid, delta);
      EXPECT_LE(grid.lower, exact.upper) << body.name << " " << delta;
      EXPECT_GE(grid.upper, exact.lower) << body.name << " " << delta;
      EXPECT_LE(grid.upper, (1 + delta) * grid.lower * (1 + 0x1p-44)) << body.name << " " << delta;
    }
  }
}

TEST(ApproximateWidth, KernelKeepsItsFactor) {
  Scratch scratch;
  for (const Body& body : bodies()) {
    const ConvexShape shape(*ConvexPolytope::from_points(body.points));
    const Width exact = width({&shape, Pose()}, scratch);
    for (const double delta : {1.0, 0.1, 1e-2, 1e-4}) {
      const ApproximateWidth found = *approximate_width(body.points, delta, scratch);
      EXPECT_LE(found.lower, exact.upper) << body.name << " " << delta;
      EXPECT_GE(found.upper, exact.lower) << body.name << " " << delta;
      EXPECT_LE(found.upper, (1 + delta) * found.lower + 1e-13) << body.name << " " << delta;
      EXPECT_NEAR(found.normal.norm(), 1, 1e-14);
    }
  }
}

/// Far from the origin rounding is as large as the bounds of the extents say, and no larger.
TEST(ApproximateWidth, KernelHoldsTheExactWidthFarOut) {
  Scratch scratch;
  scenes::Random random(53);
  for (const Body& body : bodies()) {
    for (const double far : {0x1p10, 0x1p20, 0x1p30}) {
      const Vec3 offset = far * random.direction();
      std::vector<Vec3> points = body.points;
      for (Vec3& p : points) p += offset;
      const ConvexShape shape(*ConvexPolytope::from_points(points));
      const Width exact = width({&shape, Pose()}, scratch);
      const ApproximateWidth found = *approximate_width(points, 0.1, scratch);
      EXPECT_LE(found.lower, exact.upper) << body.name << " " << far;
      EXPECT_GE(found.upper, exact.lower) << body.name << " " << far;
    }
  }
}

TEST(ApproximateWidth, KernelKeepsItsFactorAtEverySize) {
  Scratch scratch;
  for (const Body& body : bodies()) {
    for (const double scale : {0x1p-900, 0x1p-300, 0x1p260, 0x1p490}) {
      std::vector<Vec3> points = body.points;
      for (Vec3& p : points) p *= scale;
      const ConvexShape shape(*ConvexPolytope::from_points(points));
      const Width exact = width({&shape, Pose()}, scratch);
      const ApproximateWidth found = *approximate_width(points, 0.01, scratch);
      EXPECT_LE(found.lower, exact.upper) << body.name << " " << scale;
      EXPECT_GE(found.upper, exact.lower) << body.name << " " << scale;
      EXPECT_LE(found.upper, 1.01 * found.lower + 1e-13 * scale) << body.name << " " << scale;
    }
  }
}

/// Two passes to choose directions by, one over all those chosen; the kernel's own width is the certificate.
TEST(ApproximateWidth, EndsWithItsCertificate) {
  Scratch scratch;
  EXPECT_LE(approximate_width(scenes::box(Vec3(3, 1, 2)), 1, scratch)->passes, 3);
}

TEST(ApproximateWidth, ManyPointsFewPasses) {
  scenes::Random random(52);
  Scratch scratch;
  for (const int n : {2000, 20000, 200000}) {
    std::vector<Vec3> points = scenes::sphere_hull(n, random);
    for (const double squash : {1.0, 0.01}) {
      for (Vec3& p : points) p.z() *= squash;
      const ApproximateWidth found = *approximate_width(points, 1e-2, scratch);
      EXPECT_LE(found.upper, 1.01 * found.lower);
      EXPECT_LE(found.upper, 2.02 * squash);
      EXPECT_GE(found.upper, 1.9 * squash);
      // Nothing of the size of n but the passes.
      EXPECT_LE(found.kernel_size, 500);
      EXPECT_LE(found.dot_products_per_point, 192);
      for (Vec3& p : points) p.z() /= squash;
    }
  }
}

TEST(ApproximateWidth, FlatSetsAndRefusals) {
  Scratch scratch;
  const std::vector<Vec3> point{{1, 2, 3}}, line{{0, 0, 0}, {1, 2, 3}, {2, 4, 6}};
  const std::vector<Vec3> square{{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  for (const auto& flat : {point, line, square}) {
    const ApproximateWidth found = *approximate_width(flat, 0.1, scratch);
    EXPECT_EQ(found.lower, 0);
    EXPECT_LE(found.upper, 1e-13);
  }
  EXPECT_EQ(approximate_width({}, 0.1, scratch).error().code, ErrorCode::too_few_points);
  EXPECT_EQ(approximate_width(square, 0, scratch).error().code, ErrorCode::bad_value);
  EXPECT_EQ(approximate_width(square, 1.5, scratch).error().where, "delta");
  const std::vector<Vec3> bad{{0, 0, 0}, {0, std::nan(""), 0}}, far{{0, 0, 0}, {1e200, 0, 0}};
  EXPECT_EQ(approximate_width(bad, 0.1, scratch).error().code, ErrorCode::non_finite);
  EXPECT_EQ(approximate_width(bad, 0.1, scratch).error().where, "points[1]");
  EXPECT_EQ(approximate_width(far, 0.1, scratch).error().code, ErrorCode::out_of_range);
  // 1e150 is the last that is taken.
  std::vector<Vec3> wide{{0, 0, 0}, {1e150, 0, 0}, {0, 1e150, 0}, {0, 0, 1e150}};
  const auto widest = approximate_width(wide, 0.1, scratch);
  ASSERT_TRUE(widest);
  EXPECT_NEAR(widest->upper / 1e150, std::sqrt(1.0 / 3), 0.06);
  wide[1].x() = std::nextafter(1e150, HUGE_VAL);
  EXPECT_EQ(approximate_width(wide, 0.1, scratch).error().where, "points[1]");
}

TEST(ApproximateWidth, TooSmallADeltaIsRefusedAtOnce) {
  const std::vector<Vec3> corners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  Scratch scratch;
  EXPECT_TRUE(approximate_width(corners, 1e-6, scratch));
  for (const double delta : {1e-7, 1e-12, 1e-300, 5e-324}) {
    const auto width = approximate_width(corners, delta, scratch);
    ASSERT_FALSE(width) << delta;
    EXPECT_EQ(width.error().code, ErrorCode::limit_exceeded);
    EXPECT_EQ(width.error().where, "delta");
  }
}

}  // namespace
}  // namespace pd
