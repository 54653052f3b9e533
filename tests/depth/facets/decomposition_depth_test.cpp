/// @file
/// The depth engine after [A] section 2: the very facet that the overlay finds, over every family of pairs, whatever it
/// is told beforehand; and far fewer pairs of edges looked at than there are facets.
#include "depth/facets/decomposition_depth.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "depth/certificate/facet_plane.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "scenes/agarwal_families.hpp"
#include "scenes/shape_families.hpp"

namespace pd::detail {
namespace {

bool same(const Feature& x, const Feature& y) { return x.kind == y.kind && x.first == y.first && x.second == y.second; }

/// Vertices of P, not far from extreme in all directions.
std::vector<VertexPair> some_vertices(const ConvexPolytope& a, const ConvexPolytope& b) {
  std::vector<VertexPair> ids;
  for (int k = 0; k < 20; ++k) ids.push_back({(7 * k) % a.num_vertices(), (11 * k) % b.num_vertices()});
  return ids;
}

class Engines {
 public:
  void compare(const ConvexPolytope& a, const Pose& pose_a, const ConvexPolytope& b, const Pose& pose_b) {
    const PosedPair pair(a, pose_a, b, pose_b);
    const OverlayDepth overlay = overlay_depth(pair, overlay_);
    if (overlay.contact == ContactClass::separated) return;
    const std::vector<VertexPair> vertices = some_vertices(a, b);
    double depth = std::numeric_limits<double>::infinity();
    if (overlay.contact == ContactClass::overlapping) {
      const FacetPlane plane = measure_facet(pair, overlay.facet);
      if (plane.known()) depth = (to_double(plane.distance) + plane.distance_error) * (1 + 0x1p-50);
    }
    for (const bool knows_vertices : {false, true}) {
      for (const double upper : {std::numeric_limits<double>::infinity(), 1.5 * depth, depth}) {
        DecompositionSettings settings;
        settings.upper = upper;
        if (knows_vertices) settings.vertices = vertices;
        settings.seed = ++seed_;
        const DecompositionDepth found = decomposition_depth(pair, settings, overlay_, buffers_);
        ASSERT_EQ(found.nearest.contact, overlay.contact);
        ASSERT_EQ(found.nearest.has_facet, overlay.has_facet);
        if (!overlay.has_facet) continue;
        ASSERT_TRUE(same(found.nearest.facet.on_a, overlay.facet.on_a));
        ASSERT_TRUE(same(found.nearest.facet.on_b, overlay.facet.on_b));
        ++compared;
      }
    }
  }
  int compared = 0;

 private:
  OverlayDepthBuffers overlay_;
  DecompositionBuffers buffers_;
  std::uint64_t seed_ = 0;
};

TEST(DecompositionDepth, FindsTheOverlaysFacetInEveryFamily) {
  Engines engines;
  for (int f = 0; f < scenes::kPairFamilies; ++f) {
    for (int round = 0; round < 24; ++round) {
      const auto family = static_cast<scenes::PairFamily>(f);
      SCOPED_TRACE(std::string(scenes::to_string(family)) + " round " + std::to_string(round));
      const int n = std::array{4, 6, 8, 12, 24, 40}[static_cast<std::size_t>(round % 6)];
      const auto pair = scenes::make_pair(family, n, static_cast<scenes::DepthClass>(round % scenes::kDepthClasses),
                                          500 + static_cast<std::uint64_t>(round));
      engines.compare(*ConvexPolytope::from_points(pair.a), pair.pose_a, *ConvexPolytope::from_points(pair.b),
                      pair.pose_b);
      if (HasFatalFailure()) return;
    }
  }
  EXPECT_GT(engines.compared, 1500);
}

TEST(DecompositionDepth, FindsTheOverlaysFacetWhereAllAreNearlyTied) {
  Engines engines;
  for (const scenes::AgarwalFamily family : scenes::agarwal_families()) {
    for (const int m : {8, 24, 48}) {
      SCOPED_TRACE(std::string(scenes::to_string(family)) + " " + std::to_string(m));
      const auto pair = scenes::make_agarwal_pair(family, m, scenes::DepthClass::deep, static_cast<std::uint64_t>(m));
      engines.compare(pair.a, pair.pose_a, pair.b, pair.pose_b);
      if (HasFatalFailure()) return;
    }
  }
  EXPECT_GT(engines.compared, 100);
}

TEST(DecompositionDepth, LooksAtFewOfTheFacetsOfSmoothBodies) {
  OverlayDepthBuffers overlay;
  DecompositionBuffers buffers;
  for (const auto family : {scenes::AgarwalFamily::patch, scenes::AgarwalFamily::low_patch}) {
    const auto bodies = scenes::make_agarwal_pair(family, 512, scenes::DepthClass::deep, 3);
    const PosedPair pair(bodies.a, bodies.pose_a, bodies.b, bodies.pose_b);
    const OverlayDepth all = overlay_depth(pair, overlay);
    const DecompositionDepth found = decomposition_depth(pair, {}, overlay, buffers);
    ASSERT_TRUE(same(found.nearest.facet.on_a, all.facet.on_a));
    ASSERT_TRUE(same(found.nearest.facet.on_b, all.facet.on_b));
    // Without any bound to begin with.
    EXPECT_LT(found.lines.pair_evaluations + found.lines.lines_scanned, all.facets_visited);
  }
}

/// Prisms of n sides that share the plane of their ends: n^2 pieces of edges lie in it, all as near as the ends are.
ConvexPolytope prism_of(int n, double radius) {
  std::vector<Vec3> points;
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * 3.14159265358979 * i / n;
    for (const double z : {-1.0, 1.0}) points.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
  }
  return *ConvexPolytope::from_points(points);
}

TEST(DecompositionDepth, FindsTheOverlaysFacetOfPrismsWithSharedEnds) {
  Engines engines;
  const ConvexPolytope b = prism_of(24, 1);
  const Pose still;
  std::vector<Pose> poses(1);
  for (const std::array<double, 4>& q : std::vector<std::array<double, 4>>{
           {1, 0, 0, 0x1p-5}, {1, 0, 0, 1}, {0, 1, 0, 0}, {0, 3, 4, 0}, {1, 0x1p-40, 0, 0}, {1, 1, 0, 0}}) {
    const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    poses.push_back(*Pose::from_quaternion({q[0] / length, q[1] / length, q[2] / length, q[3] / length}, Vec3::Zero()));
    poses.push_back(
        *Pose::from_quaternion({q[0] / length, q[1] / length, q[2] / length, q[3] / length}, Vec3(0.25, 0.5, 0.125)));
  }
  for (const double radius : {1.0, 1 + 0x1p-30, 0.75, 3.0}) {
    const ConvexPolytope a = prism_of(20, radius);
    for (const Pose& pose : poses) {
      engines.compare(a, pose, b, still);
      engines.compare(b, pose, b, still);
      if (HasFatalFailure()) return;
    }
  }
  EXPECT_GT(engines.compared, 500);
}

TEST(DecompositionDepth, LooksAtFewPairsOfTheEdgesOfSharedEnds) {
  OverlayDepthBuffers overlay;
  DecompositionBuffers buffers;
  const Pose still;
  std::vector<std::int64_t> tried;
  for (const int n : {128, 256, 512}) {
    // Deeper across than along by n^-2, so that no bound on a distance tells the ends' pairs from the nearest facet.
    const ConvexPolytope prism = prism_of(n, 1);
    const PosedPair pair(prism, still, prism, still);
    const DecompositionDepth found = decomposition_depth(pair, {}, overlay, buffers);
    ASSERT_FALSE(found.enumerated);
    EXPECT_EQ(buffers.shared.count, 2);
    tried.push_back(found.lines.pair_evaluations);
  }
  for (std::size_t k = 1; k < tried.size(); ++k) EXPECT_LT(tried[k], 3 * tried[k - 1]);
}

TEST(DecompositionDepth, TheFrontDoorAnswersTheSameBitsAsTheOverlay) {
  Scratch scratch;
  int overlapping = 0;
  for (int f = 0; f < scenes::kPairFamilies; ++f) {
    for (int round = 0; round < 8; ++round) {
      const auto family = static_cast<scenes::PairFamily>(f);
      SCOPED_TRACE(std::string(scenes::to_string(family)) + " round " + std::to_string(round));
      const auto points = scenes::make_pair(family, 6 + 5 * round, static_cast<scenes::DepthClass>(round % 4),
                                            900 + static_cast<std::uint64_t>(round));
      const ConvexShape a(*ConvexPolytope::from_points(points.a)), b(*ConvexPolytope::from_points(points.b));
      const PosedShape posed_a{&a, points.pose_a}, posed_b{&b, points.pose_b};
      const PenetrationDepth overlay = penetration_depth(posed_a, posed_b, scratch, {.method = Method::overlay});
      const PenetrationDepth found = penetration_depth(
          posed_a, posed_b, scratch, {.method = Method::decomposition, .seed = static_cast<std::uint64_t>(round)});
      EXPECT_EQ(found.contact, overlay.contact);
      EXPECT_EQ(found.lower, overlay.lower);
      EXPECT_EQ(found.upper, overlay.upper);
      if (overlay.contact != ContactClass::overlapping) continue;
      ++overlapping;
      EXPECT_EQ(found.method, Method::decomposition);
      EXPECT_EQ(found.translation, overlay.translation);
    }
  }
  EXPECT_GT(overlapping, 80);
}

TEST(DecompositionDepth, AutoTakesItWhereManyFacetsAreNearlyTied) {
  Scratch scratch;
  const auto patch = scenes::make_agarwal_pair(scenes::AgarwalFamily::patch, 512, scenes::DepthClass::deep, 1);
  const ConvexShape a(patch.a), b(patch.b);
  const PenetrationDepth found = penetration_depth({&a, patch.pose_a}, {&b, patch.pose_b}, scratch);
  EXPECT_EQ(found.method, Method::decomposition);
  EXPECT_GT(found.statistics.pair_evaluations, 0);
  const PenetrationDepth by_tree =
      penetration_depth({&a, patch.pose_a}, {&b, patch.pose_b}, scratch, {.method = Method::decomposition});
  EXPECT_EQ(by_tree.translation, found.translation);
  EXPECT_GT(by_tree.statistics.block_bounds, 0);
  EXPECT_LT(4 * by_tree.statistics.pair_evaluations, 512 * 512);
  const auto balls = scenes::make_agarwal_pair(scenes::AgarwalFamily::balls, 512, scenes::DepthClass::deep, 1);
  const ConvexShape c(balls.a), d(balls.b);
  EXPECT_EQ(penetration_depth({&c, balls.pose_a}, {&d, balls.pose_b}, scratch).method, Method::overlay);
}

}  // namespace
}  // namespace pd::detail
