/// @file
/// Depth under polyhedral metrics: by hand, against every facet of P, the bounds between metrics, refusals.
#include "pd/depth/polyhedral_depth.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "oracle/judged_pair.hpp"
#include "pd/depth/directional_depth.hpp"

namespace pd {
namespace {

using oracle::JudgedPair;

ConvexPolytope hull(const std::vector<Vec3>& points) { return *ConvexPolytope::from_points(points); }

/// The least lambda with t in lambda Q, rounded.
double gauge(const ConvexPolytope& ball, const Vec3& t) {
  double most = 0;
  for (int f = 0; f < ball.num_facets(); ++f) {
    const Vec3& n = ball.facet_normal(f);
    most = std::max(most, n.dot(t) / n.dot(ball.vertex(ball.facet_vertices(f)[0])));
  }
  return most;
}

TEST(PolyhedralDepth, BoxesByHand) {
  Scratch scratch;
  const ConvexShape box(*ConvexPolytope::box(Vec3(1, 1, 1)));
  const Pose aside = *Pose::from_matrix(Mat3::Identity(), Vec3(0.5, 0, 0));
  // P = [-2, 2]^3 - (.5, 0, 0) = [-2.5, 1.5] x [-2, 2]^2.
  const auto depth = [&](const ConvexPolytope& ball) {
    return *polyhedral_depth({&box, aside}, {&box, Pose()}, ball, scratch);
  };
  const ConvexPolytope cube = *ConvexPolytope::box(Vec3(1, 1, 1));
  EXPECT_EQ(depth(cube).depth, 1.5);
  // The octahedron's rays are the axes.
  const ConvexPolytope octahedron = hull({{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}});
  EXPECT_EQ(depth(octahedron).depth, 1.5);
  EXPECT_EQ(depth(octahedron).translation, Vec3(1.5, 0, 0));
  EXPECT_EQ(depth(octahedron).normal, Vec3(1, 0, 0));
  // Not symmetric: moving towards +x costs five times as much, so it goes up, down or aside.
  const ConvexPolytope lopsided = hull({{0.2, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}});
  EXPECT_EQ(depth(lopsided).depth, 2);
  EXPECT_EQ(depth(lopsided).translation.x(), 0);
  EXPECT_EQ(polyhedral_depth({&box, *Pose::from_matrix(Mat3::Identity(), Vec3(3, 0, 0))}, {&box, Pose()}, cube, scratch)
                ->contact,
            ContactClass::separated);
}

class PolyhedralMetrics : public testing::TestWithParam<int> {};

TEST_P(PolyhedralMetrics, AgreeWithTheRaysAndSeparateExactly) {
  const auto family = static_cast<scenes::PairFamily>(GetParam());
  Scratch scratch;
  scenes::Random random(40);
  for (int d = 0; d < scenes::kDepthClasses; ++d) {
    for (const int n : {4, 7, 20}) {
      const JudgedPair pair = JudgedPair::of_family(family, n, static_cast<scenes::DepthClass>(d), 2);
      // A lopsided ball between the spheres of radius 0.1 and 1.
      std::vector<Vec3> points{{0.3, 0.2, 0.2}, {0.3, -0.2, -0.3}, {-0.3, 0.4, -0.2}, {-0.3, -0.2, 0.4}};
      for (int i = 0; i < 6; ++i) points.push_back(random.direction());
      const ConvexPolytope ball = hull(points);
      const auto found = polyhedral_depth(pair.a(), pair.b(), ball, scratch);
      ASSERT_TRUE(found.has_value()) << found.error().message;
      ASSERT_EQ(found->contact, pair.verdict().contact);
      if (found->contact != ContactClass::overlapping) continue;
      double least = HUGE_VAL;
      double longest = 0;
      for (int v = 0; v < ball.num_vertices(); ++v) {
        const Vec3 q = ball.vertex(v);
        const auto ray = directional_depth(pair.a(), pair.b(), q, scratch, DirectionalMethod::overlay);
        least = std::min(least, ray->depth / q.norm());
        longest = std::max(longest, q.norm());
      }
      EXPECT_NEAR(found->depth, least, 1e-14 * least);
      EXPECT_LE(found->lower, found->depth);
      EXPECT_GE(found->upper, found->depth);
      EXPECT_LE(found->upper, std::nextafter(found->lower, HUGE_VAL));
      EXPECT_NEAR(gauge(ball, found->translation), found->depth, 1e-13 * found->depth);
      const oracle::ExactPair moved(pair.exact().a(), pair.points().pose_a, pair.exact().b(), pair.points().pose_b,
                                    found->translation);
      EXPECT_TRUE(oracle::interiors_disjoint(moved, {})) << pair.name();
      // Every separating translation is at least as long as the Euclidean depth.
      const PenetrationDepth euclidean = penetration_depth(pair.a(), pair.b(), scratch);
      EXPECT_GE(found->depth * longest * (1 + 1e-14), euclidean.lower);
      const double difference = (found->witness_b - found->witness_a - found->translation).cwiseAbs().maxCoeff();
      EXPECT_LE(difference, 1e-15 * (pair.extent() + found->witness_a.cwiseAbs().maxCoeff()));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, PolyhedralMetrics, testing::Range(0, scenes::kPairFamilies), [](const auto& tested) {
  return std::string(to_string(static_cast<scenes::PairFamily>(tested.param)));
});

TEST(PolyhedralDepth, Refusals) {
  Scratch scratch;
  const ConvexShape box(*ConvexPolytope::box(Vec3(1, 1, 1)));
  const ConvexShape sphere = *ConvexShape::sphere(1);
  const PosedShape posed{&box, Pose()};
  const auto code = [&](const ConvexPolytope& ball) {
    return polyhedral_depth(posed, posed, ball, scratch).error().code;
  };
  EXPECT_EQ(code(hull({{1, 0, 0}, {0, 1, 0}, {-1, -1, 0}})), ErrorCode::not_full_dimensional);
  // On the boundary, and outside.
  EXPECT_EQ(code(hull({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}})), ErrorCode::bad_value);
  EXPECT_EQ(code(hull({{1, 1, 1}, {2, 1, 1}, {1, 2, 1}, {1, 1, 2}})), ErrorCode::bad_value);
  EXPECT_EQ(polyhedral_depth(posed, posed, hull({{1, 1, 1}, {2, 1, 1}, {1, 2, 1}, {1, 1, 2}}), scratch).error().where,
            "metric");
  EXPECT_EQ(polyhedral_depth({&sphere, Pose()}, posed, *ConvexPolytope::box(Vec3(1, 1, 1)), scratch).error().code,
            ErrorCode::unsupported);
}

}  // namespace
}  // namespace pd
