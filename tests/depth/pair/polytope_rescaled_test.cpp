/// @file
/// Polytopes of extreme sizes: answered at size 1, and brackets that hold where a length falls below the least normal
/// number.

#include <gtest/gtest.h>

#include <cmath>

#include "oracle/judged_pair.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "shape/hull/polytope_storage.hpp"

namespace pd {
namespace {

using oracle::JudgedPair;

ConvexPolytope hull(std::vector<Vec3> points, double size) {
  for (Vec3& p : points) p *= size;
  return *ConvexPolytope::from_points(points);
}

/// Spans 600 powers of two.
const std::vector<Vec3> kWedge = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0x1p-600, 0, 1}, {1, 1, 1}};

TEST(PolytopeRescaled, ABodyTimesAPowerOfTwoIsTheHullOfItsPointsThere) {
  const ConvexPolytope body = hull(kWedge, 1);
  const auto storage = detail::scaled_exactly(body.storage(), -400);
  ASSERT_NE(storage, nullptr);
  const ConvexPolytope scaled(storage), expected = hull(kWedge, 0x1p-400);
  ASSERT_EQ(scaled.num_vertices(), expected.num_vertices());
  ASSERT_EQ(scaled.num_facets(), expected.num_facets());
  EXPECT_EQ(scaled.radius(), expected.radius());
  EXPECT_EQ(scaled.centre(), expected.centre());
  EXPECT_EQ(scaled.max_abs_coordinates(), expected.max_abs_coordinates());
  for (int v = 0; v < scaled.num_vertices(); ++v) {
    EXPECT_EQ(scaled.vertex(v), expected.vertex(v));
    EXPECT_EQ(scaled.caller_id(v), expected.caller_id(v));
    EXPECT_TRUE(std::ranges::equal(scaled.neighbours(v), expected.neighbours(v)));
  }
  for (int f = 0; f < scaled.num_facets(); ++f) {
    EXPECT_TRUE(std::ranges::equal(scaled.facet_vertices(f), expected.facet_vertices(f)));
    EXPECT_NEAR((scaled.facet_normal(f) - expected.facet_normal(f)).norm(), 0, 1e-15);
  }
}

TEST(PolytopeRescaled, NoneWhereACoordinateWouldBeRounded) {
  const ConvexPolytope body = hull(kWedge, 1);
  EXPECT_NE(detail::scaled_exactly(body.storage(), -450), nullptr);
  EXPECT_EQ(detail::scaled_exactly(body.storage(), -500), nullptr);  // 2^-1100 is 0
  EXPECT_EQ(detail::scaled_exactly(body.storage(), 1100), nullptr);  // no number
}

TEST(PolytopeRescaled, TheTableOfDirectionsOfManyVerticesComesAlong) {
  scenes::Random random(7);
  std::vector<Vec3> points;
  for (int i = 0; i < 300; ++i) points.push_back(random.direction());
  const ConvexPolytope body = hull(points, 1), tiny = hull(points, 0x1p-800);
  ASSERT_GT(body.storage().table_cells, 0);
  const auto storage = detail::scaled_exactly(tiny.storage(), 800);
  ASSERT_NE(storage, nullptr);
  const ConvexShape plain(body), scaled{ConvexPolytope(storage)};
  Scratch scratch;
  for (int i = 0; i < 20; ++i) {
    const Pose pose = random.pose(1.9 * random.direction());
    const PenetrationDepth p = penetration_depth({&plain, Pose()}, {&plain, pose}, scratch);
    const PenetrationDepth q = penetration_depth({&scaled, Pose()}, {&scaled, pose}, scratch);
    EXPECT_EQ(p.lower, q.lower);
    EXPECT_EQ(p.distance_lower, q.distance_lower);
    EXPECT_EQ(p.translation, q.translation);
  }
}

/// Two boxes of size 1e-300 that share a layer of some least doubles, which is not exact at their size times 2^996.
TEST(PolytopeRescaled, BracketsHoldWhereADepthIsSubnormal) {
  const double size = 0x1p-997;
  const ConvexShape cube(*ConvexPolytope::box(Vec3::Constant(size)));
  Scratch scratch;
  int overlapping = 0;
  for (int k = 1; k < 40; ++k) {
    const Vec3 axis = Vec3(1, 0.5, 0.25 / k).normalized();
    const Pose turned = *Pose::from_quaternion({0.8, 0.6 * axis.x(), 0.6 * axis.y(), 0.6 * axis.z()},
                                               {(1.9 + 0.01 * k) * size, 0.1 * size, 0});
    const PenetrationDepth tight = penetration_depth({&cube, Pose()}, {&cube, turned}, scratch);
    // Moved out all but a few least doubles.
    const Vec3 back = tight.translation * (1 - 0x1p-60 * k);
    const Pose nearly = *Pose::from_quaternion(turned.quaternion_wxyz(), turned.translation() - back);
    const PenetrationDepth exact = penetration_depth({&cube, Pose()}, {&cube, nearly}, scratch);
    for (const Bracket bracket : {Bracket::certified, Bracket::contact}) {
      const PenetrationDepth answer =
          penetration_depth({&cube, Pose()}, {&cube, nearly}, scratch, {.bracket = bracket});
      const double s_lower = answer.contact == ContactClass::separated ? answer.distance_lower : -answer.upper;
      const double s_upper = answer.contact == ContactClass::overlapping ? -answer.lower : answer.distance_upper;
      const double least = exact.contact == ContactClass::overlapping ? -exact.upper : exact.distance_lower;
      const double most = exact.contact == ContactClass::overlapping ? -exact.lower : exact.distance_upper;
      EXPECT_LE(s_lower, most);
      EXPECT_GE(s_upper, least);
    }
    if (exact.contact == ContactClass::overlapping && exact.upper < 0x1p-1022) ++overlapping;
  }
  std::printf("%d subnormal depths\n", overlapping);
}

}  // namespace
}  // namespace pd
