/// @file
/// Faces of two solids that lie in one plane once A has left B: the point that both have, and the answers that
/// need no surface for it.
#include "depth/facets/gauss_foot.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <optional>
#include <vector>

#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"

namespace pd::detail {
namespace {

constexpr double kPi = 3.14159265358979;

/// A prism over a triangle of this radius, from z = -1 to 1.
ConvexPolytope wedge(double radius) {
  std::vector<Vec3> points;
  for (const double angle : {0.3, 2.1, 4.4}) {
    for (const double z : {-1.0, 1.0}) points.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
  }
  return *ConvexPolytope::from_points(points);
}

Pose placed(double yaw, const Vec3& at) {
  return *Pose::from_quaternion({std::cos(yaw / 2), 0, 0, std::sin(yaw / 2)}, at);
}

/// Whether `x` lies in the body at its pose up to `slack`.
bool holds(const ConvexPolytope& body, const Pose& pose, const Vec3& x, double slack) {
  for (int f = 0; f < body.num_facets(); ++f) {
    const Vec3 normal = pose.rotation() * body.facet_normal(f);
    const Vec3 corner = pose.apply(body.vertex(body.facet_vertices(f)[0]));
    if (normal.dot(x - corner) > slack) return false;
  }
  return true;
}

/// A stands on B, 2^-6 deep; nothing where their faces do not meet above each other.
std::optional<Vec3> meeting_on_top(const ConvexPolytope& a, const ConvexPolytope& b, double yaw, double x, double y) {
  const double sunk = 0x1p-6;
  const Pose pose_a = placed(yaw, Vec3(x, y, 2 - sunk)), pose_b = placed(0, Vec3::Zero());
  PolytopeDifference difference(a, pose_a, b, pose_b);
  PosedVerticesPair posed;
  difference.prepare_supports(posed);
  const std::optional<Vec3> found = meeting_point(difference, Vec3::UnitZ(), sunk, foot_rounding(difference));
  if (found) {
    EXPECT_TRUE(holds(b, pose_b, *found, 1e-13));
    EXPECT_TRUE(holds(a, pose_a, *found - sunk * Vec3::UnitZ(), 1e-13));
    EXPECT_NEAR(found->z(), 1, 1e-13);
  }
  return found;
}

TEST(FlushFaces, HaveAPointInCommonWhereTheyMeet) {
  const ConvexPolytope a = wedge(0.75), b = wedge(1);
  int meet = 0, apart = 0;
  for (int k = 0; k < 400; ++k) {
    const double x = -2 + 0.2 * (k % 20), y = -2 + 0.2 * (k / 20);
    (meeting_on_top(a, b, 0.1 * k, x, y) ? meet : apart) += 1;
    const double gap = std::hypot(x, y);
    if (gap < 0.5 || gap > 1.75 + 1e-9) {
      EXPECT_EQ(meeting_on_top(a, b, 0.1 * k, x, y).has_value(), gap < 0.5) << x << ' ' << y;
    }
  }
  EXPECT_GT(meet, 60);
  EXPECT_GT(apart, 100);
}

TEST(FlushFaces, OfAFacetAndAnEdgeOrACorner) {
  const ConvexPolytope floor = *ConvexPolytope::box(Vec3(2, 2, 1));
  // On an edge, half of which hangs over the floor's border at x = 2.
  const ConvexPolytope keel = *ConvexPolytope::from_points(
      std::vector<Vec3>{{-1, 0, -1}, {1, 0, -1}, {-1, -1, 1}, {1, -1, 1}, {-1, 1, 1}, {1, 1, 1}});
  const std::optional<Vec3> on_edge = meeting_on_top(keel, floor, 0, 2, 0);
  ASSERT_TRUE(on_edge);
  EXPECT_GT(on_edge->x(), 1);
  EXPECT_LT(on_edge->x(), 2);
  const ConvexPolytope top =
      *ConvexPolytope::from_points(std::vector<Vec3>{{0, 0, -1}, {-1, -1, 1}, {1, -1, 1}, {-1, 1, 1}, {1, 1, 1}});
  const std::optional<Vec3> on_corner = meeting_on_top(top, floor, 0.4, 0.5, -0.25);
  ASSERT_TRUE(on_corner);
  EXPECT_LT((*on_corner - Vec3(0.5, -0.25, 1)).norm(), 1e-12);
  EXPECT_FALSE(meeting_on_top(top, floor, 0.4, 2.5, 0));
  // Two edges make no facet's plane.
  const ConvexPolytope ridge = *ConvexPolytope::from_points(
      std::vector<Vec3>{{-1, 0, 1}, {1, 0, 1}, {-1, -1, -1}, {1, -1, -1}, {-1, 1, -1}, {1, 1, -1}});
  EXPECT_FALSE(meeting_on_top(keel, ridge, 0.7, 0, 0));
}

TEST(FlushFaces, AreAnsweredWithoutASurface) {
  const ConvexPolytope prism = wedge(0.5);
  const ConvexShape a(prism), b(*ConvexPolytope::box(Vec3(2, 2, 1)));
  Scratch scratch;
  for (int k = 0; k < 64; ++k) {
    // On the end, and on a side.
    const Vec3 down = k % 2 == 0 ? Vec3(0, 0, -1) : prism.facet_normal(k % prism.num_facets());
    const Mat3 turn =
        (Eigen::AngleAxisd(2 * kPi * k / 64, Vec3::UnitZ()) * Eigen::Quaterniond::FromTwoVectors(down, -Vec3::UnitZ()))
            .toRotationMatrix();
    double least = 0;
    for (int v = 0; v < prism.num_vertices(); ++v) least = std::min(least, (turn * prism.vertex(v)).z());
    const Pose pose_a = Pose::from_trusted_matrix(turn, Vec3(0.3 - 0.01 * k, 0.2, 1 - 0x1p-8 - least));
    const PenetrationDepth found =
        penetration_depth({&a, pose_a}, {&b, Pose()}, scratch, {.bracket = Bracket::certified});
    EXPECT_EQ(found.method, Method::overlay) << k;
    EXPECT_NEAR(found.depth, 0x1p-8, 1e-13);
    EXPECT_LE(found.upper - found.lower, 2e-14 * 5);
    EXPECT_LT((found.witness_b - found.witness_a - found.translation).norm(), 1e-15);
    EXPECT_TRUE(holds(prism, pose_a, found.witness_a, 1e-13)) << k;
    EXPECT_TRUE(holds(*b.polytope(), Pose(), found.witness_b, 1e-13)) << k;
    EXPECT_NEAR(found.witness_b.z(), 1, 1e-13);
  }
}

}  // namespace
}  // namespace pd::detail
