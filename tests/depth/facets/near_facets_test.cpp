/// @file
/// Nearly tied facets measured pair by pair (certified bracket) against the exact depth, over every family of pairs,
/// and when an expansion leaves them to that.
#include "depth/facets/near_facets.hpp"

#include <gtest/gtest.h>

#include <string>

#include "depth/expansion/expansion_budget.hpp"
#include "depth/facets/line_kernels.hpp"
#include "oracle/answer_check.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "scenes/agarwal_families.hpp"
#include "scenes/shape_families.hpp"

namespace pd::detail {
namespace {

using scenes::DepthClass;
using scenes::PairFamily;

constexpr double kWidth = 1.8e-14;

/// Vertices of P that are extreme in the directions of a cube's corners and axes.
InnerSurface some_surface(const PolytopeDifference& difference) {
  InnerSurface surface;
  surface.clear();
  for (int k = 0; k < 27; ++k) {
    const Vec3 direction(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1);
    if (direction.squaredNorm() > 0) surface.vertices.push_back(difference.support(direction, nullptr));
  }
  return surface;
}

struct Tally {
  int asked = 0;
  int certified = 0;
};

/// Asks with bounds that are `slack` wide on either side.
void ask(const ConvexPolytope& a, const Pose& pose_a, const ConvexPolytope& b, const Pose& pose_b, double slack,
         Tally& tally) {
  Scratch scratch;
  const ConvexShape shape_a(a), shape_b(b);
  const PenetrationDepth exact = penetration_depth({&shape_a, pose_a}, {&shape_b, pose_b}, scratch);
  if (exact.contact != ContactClass::overlapping) return;
  PosedVerticesPair posed;
  PolytopeDifference difference(a, pose_a, b, pose_b);
  difference.prepare_supports(posed);
  const double rounding = 1e-13 * difference.reach();
  const NearFacetsSettings settings{exact.lower / slack - rounding, exact.upper * slack + rounding, kWidth};
  if (!(settings.lower > 0)) return;
  const InnerSurface surface = some_surface(difference);
  std::vector<std::int32_t> stack;
  NearFacetsBuffers buffers;
  const NearFacets found = nearest_of_near_facets(a, pose_a, b, pose_b, difference, surface, settings, stack, buffers);
  ++tally.asked;
  if (!found.certified) return;
  ++tally.certified;
  EXPECT_LE(found.lower, exact.upper);
  EXPECT_GE(found.upper, exact.lower);
  EXPECT_LE(found.upper - found.lower, kWidth * difference.reach());
  EXPECT_NEAR(found.normal.norm(), 1, 1e-15);
}

class NearFacetsOfFamilies : public ::testing::TestWithParam<PairFamily> {};

TEST_P(NearFacetsOfFamilies, BracketsHoldTheExactDepth) {
  Tally tally;
  for (const double slack : {1.0, 1.02, 2.0}) {
    for (const DepthClass depth : {DepthClass::shallow, DepthClass::mid, DepthClass::deep}) {
      for (const int n : {6, 8, 16, 24}) {
        for (std::uint64_t seed = 1; seed <= 6; ++seed) {
          SCOPED_TRACE(testing::Message() << "slack " << slack << ", depth " << static_cast<int>(depth) << ", n " << n
                                          << ", seed " << seed);
          const scenes::PointPair pair = scenes::make_pair(GetParam(), n, depth, seed);
          const auto a = ConvexPolytope::from_points(pair.a);
          const auto b = ConvexPolytope::from_points(pair.b);
          ASSERT_TRUE(a && b);
          ask(*a, pair.pose_a, *b, pair.pose_b, slack, tally);
        }
      }
    }
  }
  // Flat bodies are refused, and where edges are parallel too much is left to slivers; of the others most are decided.
  RecordProperty("asked", tally.asked);
  RecordProperty("certified", tally.certified);
  const bool flat = GetParam() == PairFamily::polygons || GetParam() == PairFamily::segments;
  if (flat) {
    EXPECT_EQ(tally.certified, 0);
  } else if (GetParam() != PairFamily::cubes && GetParam() != PairFamily::grid) {
    EXPECT_GE(10 * tally.certified, 3 * tally.asked) << tally.certified << " of " << tally.asked;
  }
}

INSTANTIATE_TEST_SUITE_P(All, NearFacetsOfFamilies,
                         ::testing::Values(PairFamily::box, PairFamily::cubes, PairFamily::sphere, PairFamily::needle,
                                           PairFamily::prism, PairFamily::grid, PairFamily::patch, PairFamily::roofs,
                                           PairFamily::tilted_roofs, PairFamily::slivers, PairFamily::polygons,
                                           PairFamily::segments),
                         [](const auto& family) { return std::string(scenes::to_string(family.param)); });

TEST(NearFacets, QuadraticFamiliesAreDecidedWithoutATree) {
  for (const scenes::AgarwalFamily family : scenes::agarwal_families()) {
    SCOPED_TRACE(std::string(scenes::to_string(family)));
    Tally tally;
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const scenes::PolytopePair pair = scenes::make_agarwal_pair(family, 24, DepthClass::deep, seed);
      ask(pair.a, pair.pose_a, pair.b, pair.pose_b, 1.001, tally);
    }
    if (scenes::is_quadratic(family)) {
      EXPECT_EQ(tally.certified, tally.asked);
    }
  }
}

class NearFacetsOfRoofs : public ::testing::TestWithParam<Bracket> {};

TEST_P(NearFacetsOfRoofs, KeepEveryPromiseWithoutATree) {
  Scratch scratch;
  const auto points = [](const ConvexPolytope& body) {
    scenes::Points out;
    for (int v = 0; v < body.num_vertices(); ++v) out.push_back(body.vertex(v));
    return out;
  };
  for (const int n : {64, 96}) {
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      SCOPED_TRACE(testing::Message() << "n " << n << ", seed " << seed);
      const scenes::PolytopePair pair = scenes::crossed_roofs(n, 1, seed);
      const scenes::Points points_a = points(pair.a), points_b = points(pair.b);
      const ConvexPolytope hull_a = *ConvexPolytope::from_points(points_a);
      const ConvexPolytope hull_b = *ConvexPolytope::from_points(points_b);
      const ConvexShape a(hull_a), b(hull_b);
      const PenetrationDepth answer =
          penetration_depth({&a, pair.pose_a}, {&b, pair.pose_b}, scratch, {.bracket = GetParam()});
      EXPECT_EQ(answer.method, Method::decomposition);
      EXPECT_GT(answer.statistics.pair_evaluations, 0);
      EXPECT_EQ(answer.statistics.block_bounds, 0);
      EXPECT_LE(answer.statistics.exact_signs, GetParam() == Bracket::certified ? 0 : 2);
      EXPECT_LT(answer.statistics.support_calls, 128);
      const oracle::Body body_a(points_a), body_b(points_b);
      const oracle::ExactPair exact(body_a, pair.pose_a, body_b, pair.pose_b);
      const oracle::Findings findings = oracle::check_answer(
          exact, oracle::judge(exact), {&hull_a, &hull_b, &pair.pose_a, &pair.pose_b, GetParam()}, answer);
      for (const oracle::Breach& breach : findings.wrong) ADD_FAILURE() << breach.what;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Both, NearFacetsOfRoofs, ::testing::Values(Bracket::certified, Bracket::tightest),
                         [](const auto& bracket) {
                           return std::string(bracket.param == Bracket::certified ? "certified" : "tightest");
                         });

TEST(NearFacets, AnswersDoNotDependOnWhatTheBuffersHeld) {
  const auto answer = [](Scratch& scratch) {
    const scenes::PolytopePair pair = scenes::crossed_roofs(80, 1, 3);
    const ConvexShape a(pair.a), b(pair.b);
    return penetration_depth({&a, pair.pose_a}, {&b, pair.pose_b}, scratch, {.bracket = Bracket::certified});
  };
  Scratch fresh, used;
  for (const int n : {128, 64}) {
    const scenes::PolytopePair pair = scenes::crossed_roofs(n, 1, 9);
    const ConvexShape a(pair.a), b(pair.b);
    (void)penetration_depth({&a, pair.pose_a}, {&b, pair.pose_b}, used, {.bracket = Bracket::certified});
  }
  const PenetrationDepth x = answer(fresh), y = answer(used);
  EXPECT_EQ(x.lower, y.lower);
  EXPECT_EQ(x.upper, y.upper);
  EXPECT_EQ(x.witness_a, y.witness_a);
}

TEST(LineLanes, KeepExactlyTheLinesWithinTheRadius) {
  // Lines of A along x at heights z = 0, 1, 2, ...; b along y through the origin, so that N = z and t = 0.
  constexpr int kCount = 70;
  std::vector<double> coordinates[6];
  for (auto& c : coordinates) c.assign(static_cast<std::size_t>(padded_to_lines(kCount)), 0.0);
  for (std::size_t j = 0; j < kCount; ++j) {
    const Vec3 direction = Vec3::UnitX();
    const Vec3 moment = Vec3(0, 0, static_cast<double>(j)).cross(direction);
    for (std::size_t k = 0; k < 3; ++k) {
      coordinates[k][j] = moment[static_cast<Eigen::Index>(k)];
      coordinates[k + 3][j] = direction[static_cast<Eigen::Index>(k)];
    }
  }
  LineArrays lines;
  lines.count = kCount;
  for (std::size_t k = 0; k < 6; ++k) lines.coordinates[k] = coordinates[k].data();
  std::uint64_t near[2];
  lines_near(lines, {0, 1, 0, 0, 0, 0}, 66.5, 1e-14, near);
  EXPECT_EQ(near[0], ~std::uint64_t{0});
  EXPECT_EQ(near[1], std::uint64_t{7});  // 64, 65, 66; no padding
  lines_near(lines, {0, 1, 0, 0, 0, 0}, 2.5, 1e-14, near);
  EXPECT_EQ(near[0], std::uint64_t{7});
  EXPECT_EQ(near[1], std::uint64_t{0});
}

TEST(LineLanes, SetABitForEachProbeBeyondANormalsLevel) {
  ProbeArrays test_points;
  for (std::size_t k = 0; k < kMaskProbes; ++k) {
    test_points.x[k] = static_cast<float>(k);
    test_points.y[k] = -1;
    test_points.z[k] = 0;
  }
  const double normals[6] = {1, 0, 0, 0, 1, 0};
  const float levels[2] = {kMaskProbes - 1.5F, -0.5F};
  std::uint32_t masks[2];
  probes_beyond(normals, 2, test_points, levels, masks);
  EXPECT_EQ(masks[0], std::uint32_t{1} << (kMaskProbes - 1));
  EXPECT_EQ(masks[1], 0U);
}

TEST(ExpansionBudget, IsSpentOnEvenlySpreadFacetsBeforeTheyAreMet) {
  Scratch scratch;
  const scenes::PolytopePair pair = scenes::ball_pair(512, 2, 1);
  const ConvexShape a(pair.a), b(pair.b);
  const PenetrationDepth answer =
      penetration_depth({&a, pair.pose_a}, {&b, pair.pose_b}, scratch, {.bracket = Bracket::certified});
  EXPECT_NE(answer.method, Method::expansion);
  EXPECT_LE(answer.statistics.support_calls, 224);
}

TEST(ExpansionBudget, LeavesRoundBodiesToTheExpansionAndRoofsToTheLanes) {
  Scratch scratch;
  const auto method = [&](const ConvexPolytope& a, const Pose& pose_a, const ConvexPolytope& b, const Pose& pose_b) {
    const ConvexShape x(a), y(b);
    return penetration_depth({&x, pose_a}, {&y, pose_b}, scratch, {.bracket = Bracket::certified}).method;
  };
  for (const int n : {128, 512, 1024}) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const scenes::PointPair round = scenes::make_pair(PairFamily::sphere, n, DepthClass::deep, seed);
      EXPECT_EQ(method(*ConvexPolytope::from_points(round.a), round.pose_a, *ConvexPolytope::from_points(round.b),
                       round.pose_b),
                Method::expansion)
          << n << ", seed " << seed;
      const scenes::PolytopePair roofs = scenes::crossed_roofs(n, 1, seed);
      EXPECT_EQ(method(roofs.a, roofs.pose_a, roofs.b, roofs.pose_b), Method::decomposition) << n << ", seed " << seed;
    }
  }
}

}  // namespace
}  // namespace pd::detail
