/// @file
/// Approx-Separation: (1 + delta) never broken, against the exact oracle on every family and the expansion on smooth
/// bodies.
#include <gtest/gtest.h>

#include <cmath>

#include "oracle/judged_pair.hpp"
#include "pd/depth/difference_queries.hpp"

namespace pd {
namespace {

using oracle::JudgedPair;
using oracle::Promise;

class GridMethod : public testing::TestWithParam<int> {};

TEST_P(GridMethod, KeepsItsFactor) {
  const auto family = static_cast<scenes::PairFamily>(GetParam());
  Scratch scratch;
  const double deltas[] = {1, 0.3, 1e-2, 1e-4, 1e-6};
  int turn = GetParam();
  for (int d = 0; d < scenes::kDepthClasses; ++d) {
    for (const int n : {4, 6, 9, 24}) {
      for (std::uint64_t seed = 1; seed <= 3; ++seed) {
        const JudgedPair pair = JudgedPair::of_family(family, n, static_cast<scenes::DepthClass>(d), seed);
        const double delta = deltas[turn++ % 5];
        const PenetrationDepth answer =
            penetration_depth(pair.a(), pair.b(), scratch, {.method = Method::grid, .delta = delta});
        EXPECT_EQ(answer.method, Method::grid);
        if (answer.contact == ContactClass::overlapping) {
          EXPECT_LE(answer.upper, (1 + delta) * answer.lower * (1 + 0x1p-44)) << pair.name() << " delta " << delta;
        }
        // Every promise but the width of the bracket, and the features of an optimum that is not sought.
        const oracle::Findings findings =
            check_answer(pair.exact(), pair.verdict(),
                         {pair.a().shape->polytope(), pair.b().shape->polytope(), &pair.points().pose_a,
                          &pair.points().pose_b, Bracket::tightest},
                         answer);
        for (const oracle::Breach& breach : findings.wrong) {
          if (answer.contact == ContactClass::overlapping &&
              (breach.promise == Promise::width || breach.promise == Promise::feature)) {
            continue;
          }
          ADD_FAILURE() << pair.name() << " seed " << seed << " delta " << delta << " " << breach.what;
        }
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, GridMethod, testing::Range(0, scenes::kPairFamilies), [](const auto& tested) {
  return std::string(to_string(static_cast<scenes::PairFamily>(tested.param)));
});

TEST(Grid, SmoothAndSweptBodies) {
  scenes::Random random(5);
  Scratch scratch;
  const ConvexPolytope rock = *ConvexPolytope::from_points(scenes::sphere_hull(20, random));
  const ConvexShape shapes[] = {
      *ConvexShape::ellipsoid(Vec3(1, 0.5, 2)),
      *ConvexShape::cylinder(0.7, 1.2, 1),
      *ConvexShape::cone(1, 0.6, 0),
      *ConvexShape::hull_of_spheres(std::vector<Sphere>{{{0, 0, 0}, 0.8}, {{1, 0.2, 0}, 0.4}, {{0, 1, 0.5}, 0.1}}),
      *ConvexShape::sphere(0.8),
      *ConvexShape::capsule(0.4, 0.9, 2),
      *ConvexShape(rock).with_margin(0.1),
      *ConvexShape::cylinder(1, 0.1, 2)->with_margin(0.3),
      ConvexShape(rock)};
  int overlapping = 0;
  for (const ConvexShape& a : shapes) {
    for (const ConvexShape& b : shapes) {
      for (const double delta : {0.5, 1e-2, 1e-3}) {
        const PosedShape posed_a{&a, random.pose(0.8 * random.direction())};
        const PosedShape posed_b{&b, random.pose(Vec3::Zero())};
        const PenetrationDepth grid =
            penetration_depth(posed_a, posed_b, scratch, {.method = Method::grid, .delta = delta});
        const PenetrationDepth fine = penetration_depth(posed_a, posed_b, scratch, {.delta = 1e-5});
        ASSERT_EQ(grid.contact, fine.contact);
        if (grid.contact != ContactClass::overlapping) continue;
        ++overlapping;
        EXPECT_LE(grid.lower, fine.upper);
        EXPECT_GE(grid.upper, fine.lower);
        EXPECT_LE(grid.upper, (1 + delta) * grid.lower * (1 + 1e-12));
        EXPECT_LT((grid.translation - (grid.witness_b - grid.witness_a)).norm(), 1e-12);
        // The translation reaches the supporting plane in its own direction.
        const double height = support_of_difference(posed_a, posed_b, grid.normal)->value;
        EXPECT_LE(height, grid.translation.norm() * (1 + 1e-12));
      }
    }
  }
  EXPECT_GT(overlapping, 100);
}

TEST(Grid, IsMonotoneInDeltaAndNearlyProportionalToItsInverse) {
  // Concentric round bodies are the worst case: every cell matters.
  scenes::Random random(6);
  Scratch scratch;
  const ConvexShape a(*ConvexPolytope::from_points(scenes::sphere_hull(400, random)));
  const ConvexShape b(*ConvexPolytope::from_points(scenes::sphere_hull(400, random)));
  double width = 1e9;
  for (const double delta : {1.0, 0.1, 1e-2, 1e-3}) {
    const PenetrationDepth grid =
        penetration_depth({&a, Pose()}, {&b, Pose()}, scratch, {.method = Method::grid, .delta = delta});
    EXPECT_LE(grid.upper - grid.lower, width);
    width = grid.upper - grid.lower;
    EXPECT_LT(static_cast<double>(grid.statistics.facets_visited), 100 + 12 / delta) << delta;
  }
}

/// Signs of coordinates that span 440 decades take long numbers: the search is ended by what they cost, not only by its
/// 100,000 rays, and says so.
TEST(Grid, WildExponentsHaveABudget) {
  constexpr double kSizes[] = {1e-300, 1e-200, 1e-100, 1e-30, 1, 1, 1, 1e30, 1e100, 1e140};
  scenes::Random random(5);
  Scratch scratch;
  int ended = 0;
  for (int pair = 0; pair < 12; ++pair) {
    scenes::Points points[2];
    for (scenes::Points& body : points) {
      for (int i = random.integer(4, 8); i > 0; --i) {
        const Vec3 p = random.point(-1, 1);
        const double x = kSizes[random.integer(0, 9)], y = kSizes[random.integer(0, 9)];
        body.emplace_back(x * p.x(), y * p.y(), kSizes[random.integer(0, 9)] * p.z());
      }
    }
    const ConvexShape a(*ConvexPolytope::from_points(points[0]));
    const ConvexShape b(*ConvexPolytope::from_points(points[1]));
    const PenetrationDepth exact = penetration_depth({&a, Pose()}, {&b, Pose()}, scratch);
    const PenetrationDepth grid =
        penetration_depth({&a, Pose()}, {&b, Pose()}, scratch, {.method = Method::grid, .delta = 1e-2});
    ASSERT_EQ(grid.contact, exact.contact);
    if (exact.contact != ContactClass::overlapping) continue;
    EXPECT_LE(grid.lower, exact.upper);
    EXPECT_GE(grid.upper, exact.lower);
    EXPECT_EQ(grid.bracket_reached, grid.upper <= 1.01 * grid.lower * (1 + 1e-12));
    EXPECT_LT(grid.statistics.facets_visited, 20000);
    ended += grid.bracket_reached ? 0 : 1;
  }
  EXPECT_GT(ended, 2);
}

}  // namespace
}  // namespace pd
