/// @file
/// Shallow-Penetration: every promise of an exact engine on every family, the printed step's counterexample, and the
/// cost counted.
#include <gtest/gtest.h>

#include <cmath>

#include "oracle/judged_pair.hpp"
#include "pd/depth/difference_queries.hpp"
#include "pd/depth/directional_depth.hpp"
#include "pd/depth/shallow_penetration.hpp"
#include "pd/structure/direction_grid.hpp"

namespace pd {
namespace {

using oracle::JudgedPair;

class ShallowMethod : public testing::TestWithParam<int> {};

TEST_P(ShallowMethod, EveryPromiseIsKept) {
  const auto family = static_cast<scenes::PairFamily>(GetParam());
  Scratch scratch;
  const double deltas[] = {1, 0.5, 0.25};
  int turn = GetParam();
  for (int d = 0; d < scenes::kDepthClasses; ++d) {
    for (const int n : {4, 6, 9, 24}) {
      for (std::uint64_t seed = 1; seed <= 2; ++seed) {
        const JudgedPair pair = JudgedPair::of_family(family, n, static_cast<scenes::DepthClass>(d), seed);
        const double delta = deltas[turn++ % 3];
        const auto found = shallow_penetration(pair.a(), pair.b(), scratch, delta);
        ASSERT_TRUE(found.has_value());
        EXPECT_EQ(found->answer.method, Method::shallow);
        const std::string complaint = pair.complaint(found->answer, Bracket::tightest);
        ASSERT_TRUE(complaint.empty()) << "seed " << seed << " delta " << delta << " " << complaint;
        const PenetrationDepth front_door =
            penetration_depth(pair.a(), pair.b(), scratch, {.method = Method::shallow, .delta = delta});
        EXPECT_EQ(front_door.lower, found->answer.lower);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, ShallowMethod, testing::Range(0, scenes::kPairFamilies), [](const auto& tested) {
  return std::string(to_string(static_cast<scenes::PairFamily>(tested.param)));
});

ConvexShape slab(double half_width) { return *ConvexPolytope::box(Vec3(half_width, half_width, 0.5)); }

TEST(Shallow, TheSlabDefeatsThePrintedSeed) {
  // P = [-L, L]^2 x [-1, 1]: two slabs of half the size.
  const double length = 1000, delta = 0.1;
  const ConvexShape body = slab(length / 2);
  const PosedShape a{&body, Pose()};
  Scratch scratch;
  // Steps 1 to 4 of [A]: the grid at delta / 4, Delta, G', and the ball.
  const DirectionGrid grid = *direction_grid(GridKind::geodesic, delta / 4);
  double least = HUGE_VAL;
  std::vector<double> depths;
  for (const Vec3& u : grid.directions) {
    depths.push_back(directional_depth(a, a, u, scratch)->upper);
    least = std::min(least, depths.back());
  }
  const double radius = (1 + delta / 2) * least;
  int short_rays = 0;
  for (std::size_t i = 0; i < depths.size(); ++i) {
    if (depths[i] > (1 + delta / 4) * least) continue;
    ++short_rays;
    // Step 5(i) as printed: the face supported by the plane orthogonal to u. It is a corner of P, outside the ball: the
    // component that the search should start from is empty, and the facet z = 1 at distance 1 is never seen.
    const DifferenceSupport face = *support_of_difference(a, a, grid.directions[i]);
    const Vec3 corner = body.polytope()->vertex(face.vertex_b) - body.polytope()->vertex(face.vertex_a);
    const bool vertical = std::abs(grid.directions[i].z()) == 1;
    EXPECT_TRUE(vertical || corner.norm() > radius);
  }
  EXPECT_GE(short_rays, 2);
  // The corrected seed finds it.
  const ShallowPenetration found = *shallow_penetration(a, a, scratch, delta);
  EXPECT_EQ(found.answer.lower, 1);
  EXPECT_LE(found.counts.radius, (1 + delta) * 1);
}

/// Facets of P within a radius of the origin: every piece of the overlay whose polygon comes that close (by its plane,
/// an upper bound of the count).
TEST(Shallow, CostFollowsTheFacetsNearTheOrigin) {
  scenes::Random random(3);
  Scratch scratch;
  // A shallow contact of two round bodies: K_delta stays small while K grows with n.
  for (const int n : {100, 1000, 4000}) {
    const ConvexShape ball(*ConvexPolytope::from_points(scenes::sphere_hull(n, random)));
    const Pose aside = *Pose::from_matrix(Mat3::Identity(), 1.9 * random.direction());
    for (const double delta : {1.0, 0.25}) {
      const ShallowPenetration found = *shallow_penetration({&ball, aside}, {&ball, Pose()}, scratch, delta);
      const PenetrationDepth exact = penetration_depth({&ball, aside}, {&ball, Pose()}, scratch);
      EXPECT_EQ(found.answer.lower, exact.lower);
      const ShallowCounts& c = found.counts;
      EXPECT_LE(static_cast<double>(c.directions), 40 + 4 * 3.7 / delta);
      EXPECT_LE(static_cast<double>(c.steps), 8.0 * static_cast<double>(c.visited) + 8);
      EXPECT_LE(static_cast<double>(c.degrees), 10.0 * static_cast<double>(c.steps));
      EXPECT_LE(c.radius, (1 + delta) * exact.upper * (1 + 1e-9));
      // A cap of depth .1 sees about a twentieth of the sphere, and (1 + delta) times as deep a cap that much more.
      EXPECT_LT(static_cast<double>(c.visited), 0.25 * (1 + delta) * 7.0 * n) << n;
    }
  }
}

/// The answer is exact whatever delta is, so that a fine one takes no more rays than pay.
TEST(Shallow, AFineDeltaTakesNoMoreRays) {
  scenes::Random random(9);
  Scratch scratch;
  const ConvexShape a(*ConvexPolytope::from_points(scenes::sphere_hull(32, random)));
  const ConvexShape b(*ConvexPolytope::from_points(scenes::sphere_hull(32, random)));
  const Pose aside = *Pose::from_quaternion({1, 0, 0, 0}, {0.5, 0.25, 0});
  const PenetrationDepth exact = penetration_depth({&a, Pose()}, {&b, aside}, scratch);
  const PenetrationDepth fine =
      penetration_depth({&a, Pose()}, {&b, aside}, scratch, {.method = Method::shallow, .delta = 1.1e-5});
  EXPECT_EQ(fine.lower, exact.lower);
  EXPECT_EQ(fine.upper, exact.upper);
  EXPECT_LT(fine.statistics.support_calls, 100'000);
}

TEST(Shallow, Refusals) {
  Scratch scratch;
  const ConvexShape box(*ConvexPolytope::box(Vec3(1, 1, 1)));
  const ConvexShape cone = *ConvexShape::cone(1, 1, 2);
  for (const double delta : {0.0, 2.0, std::nan("")}) {
    EXPECT_EQ(shallow_penetration({&box, Pose()}, {&box, Pose()}, scratch, delta).error().code, ErrorCode::bad_value);
  }
  EXPECT_EQ(shallow_penetration({&cone, Pose()}, {&box, Pose()}, scratch, 0.5).error().code, ErrorCode::unsupported);
  const auto refused = shallow_penetration({&box, Pose()}, {&box, Pose()}, scratch, 1e-3, Bracket::tightest, 100);
  EXPECT_EQ(refused.error().code, ErrorCode::limit_exceeded);
  EXPECT_NE(refused.error().message.find("a grid of delta / 4, and delta = 0.00025 needs"), std::string::npos)
      << refused.error().message;
}

/// The engine is the caller's choice, and yet no pair and no delta ends the process.
TEST(Shallow, FallsBackWhereItDoesNotAnswer) {
  const ConvexShape egg = *ConvexShape::ellipsoid({1, 2, 3}), box(*ConvexPolytope::box({1, 1, 1}));
  const Pose aside = *Pose::from_matrix(Mat3::Identity(), {0.5, 0.25, 0});
  Scratch scratch;
  const PenetrationDepth automatic = penetration_depth({&egg, Pose()}, {&box, aside}, scratch);
  const PenetrationDepth shallow =
      penetration_depth({&egg, Pose()}, {&box, aside}, scratch, {.method = Method::shallow});
  EXPECT_EQ(shallow.depth, automatic.depth);
  for (const double delta : {HUGE_VAL, std::nan(""), -1.0, 1e-300}) {
    const DepthSettings settings{.method = Method::shallow, .delta = delta};
    EXPECT_EQ(penetration_depth({&box, Pose()}, {&box, aside}, scratch, settings).depth, 1.5);
  }
}

}  // namespace
}  // namespace pd
