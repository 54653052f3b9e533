/// @file
/// Each family on which the bounds of [A] are measured has the K that it promises, counted by the exact overlay, and
/// stands as deep as asked.
#include "scenes/agarwal_families.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "pd/structure/overlay.hpp"

namespace pd::scenes {
namespace {

OverlayCounts counts(const PolytopePair& pair) {
  Overlay overlay;
  return overlay.count(pair.a, pair.pose_a, pair.b, pair.pose_b, OverlayPieces::united);
}

PenetrationDepth depth_of(const PolytopePair& pair) {
  Scratch scratch;
  const ConvexShape a(pair.a), b(pair.b);
  return penetration_depth({&a, pair.pose_a}, {&b, pair.pose_b}, scratch, {});
}

TEST(AgarwalFamilies, GridsHaveTheSquareOfTheirProfile) {
  for (const AgarwalFamily family : agarwal_families()) {
    if (!is_quadratic(family) || family == AgarwalFamily::fogel_halperin_weibel) continue;
    for (const int m : {4, 10, 32, 128, 300}) {
      for (const std::uint64_t seed : {1u, 2u, 3u}) {
        const OverlayCounts k = counts(make_agarwal_pair(family, m, DepthClass::deep, seed));
        const std::int64_t square = static_cast<std::int64_t>(m) * m;
        EXPECT_GE(k.edge_edge, square) << to_string(family) << " m " << m << " seed " << seed;
        EXPECT_LE(k.total(), square + 20 * m + 60) << to_string(family) << " m " << m << " seed " << seed;
      }
    }
  }
}

// The arcs of eta = 1 / m curve by 1e-14 of their height: the hull keeps every edge all the same.
TEST(AgarwalFamilies, FlatArcsLoseNoEdge) {
  for (const double eta : {0.5, 1.0 / 4096}) {
    const PolytopePair pair = round_patch(4096, {eta, 0.2, 0}, 1, 5);
    EXPECT_EQ(pair.a.num_vertices(), 2 * 4097 + 8);
    EXPECT_EQ(pair.b.num_vertices(), 2 * 4097 + 8);
  }
}

TEST(AgarwalFamilies, FogelHalperinWeibelReachTheMostThatIsPossible) {
  for (const int m : {4, 5, 6, 7, 11, 20, 50, 100}) {
    for (const int n : {4, 5, 9, 13, 40, 200}) {
      const PolytopePair pair = fogel_halperin_weibel(m, n, 0.1);
      ASSERT_EQ(pair.a.num_facets(), m);
      ASSERT_EQ(pair.b.num_facets(), n);
      EXPECT_EQ(counts(pair).total(), 4 * m * n - 9 * m - 9 * n + 26) << m << " " << n;
    }
  }
}

TEST(AgarwalFamilies, BallsAndHullsAreLinear) {
  for (const AgarwalFamily family : {AgarwalFamily::sphere_hulls, AgarwalFamily::balls}) {
    for (const int n : {16, 64, 256, 1024}) {
      const std::int64_t k = counts(make_agarwal_pair(family, n, DepthClass::deep, 4)).total();
      EXPECT_GE(k, 4 * n);
      EXPECT_LE(k, 8 * n);
    }
  }
}

TEST(AgarwalFamilies, StandAsDeepAsAsked) {
  for (const AgarwalFamily family : agarwal_families()) {
    for (const DepthClass depth : {DepthClass::gap, DepthClass::shallow, DepthClass::mid, DepthClass::deep}) {
      const PenetrationDepth answer = depth_of(make_agarwal_pair(family, 24, depth, 6));
      const std::string what = std::string(to_string(family)) + " " + std::string(to_string(depth));
      if (depth == DepthClass::gap) {
        EXPECT_EQ(answer.contact, ContactClass::separated) << what;
        continue;
      }
      ASSERT_EQ(answer.contact, ContactClass::overlapping) << what;
      if (depth == DepthClass::shallow) {
        EXPECT_LE(answer.depth, 0.0101) << what;
        EXPECT_GE(answer.depth, 0.001) << what;
      } else if (depth == DepthClass::mid) {
        EXPECT_LE(answer.depth, 0.101) << what;
      } else {
        EXPECT_GE(answer.depth, 0.1) << what;
      }
    }
  }
}

// A patch one radius deep: whatever direction within its slopes, the way out is as long to a few parts in a thousand.
TEST(AgarwalFamilies, FacetsOfAPatchAreNearlyTied) {
  const PolytopePair pair = make_agarwal_pair(AgarwalFamily::patch, 200, DepthClass::deep, 8);
  const PenetrationDepth answer = depth_of(pair);
  EXPECT_NEAR(answer.depth, 1, 1e-3);
}

TEST(AgarwalFamilies, SameSeedSameNumbers) {
  const PolytopePair once = make_agarwal_pair(AgarwalFamily::tilt_noise, 20, DepthClass::mid, 9);
  const PolytopePair again = make_agarwal_pair(AgarwalFamily::tilt_noise, 20, DepthClass::mid, 9);
  const PolytopePair other = make_agarwal_pair(AgarwalFamily::tilt_noise, 20, DepthClass::mid, 10);
  EXPECT_EQ(once.pose_b, again.pose_b);
  EXPECT_FALSE(once.pose_b == other.pose_b);
  ASSERT_EQ(once.a.num_vertices(), again.a.num_vertices());
  for (int v = 0; v < once.a.num_vertices(); ++v) EXPECT_EQ(once.a.vertex(v), again.a.vertex(v));
}

}  // namespace
}  // namespace pd::scenes
