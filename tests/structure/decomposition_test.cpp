/// @file
/// The decomposition F: (C2) and (C3) against the overlay over every family of pairs, (C4) where the bodies meet, sizes
/// as (C5) and the papers' equation (1) bound them, and a count done by hand.
#include "pd/structure/decomposition.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "scenes/shape_families.hpp"

namespace pd {
namespace {

constexpr std::int64_t kLimit = std::int64_t{1} << 24;

struct Bodies {
  explicit Bodies(const scenes::PointPair& points)
      : a(*ConvexPolytope::from_points(points.a)),
        b(*ConvexPolytope::from_points(points.b)),
        pose_a(points.pose_a),
        pose_b(points.pose_b) {}
  ConvexPolytope a;
  ConvexPolytope b;
  Pose pose_a;
  Pose pose_b;
  [[nodiscard]] Decomposition decomposed() const { return Decomposition::of(a, pose_a, b, pose_b); }
  [[nodiscard]] DecompositionCheck check(const Decomposition& f) const {
    return *check_decomposition(f, a, pose_a, b, pose_b, kLimit);
  }
};

/// Two lenses at right angles, slightly turned: (2 m)^2 / 8 facets and more.
Bodies crossed_lenses(int m) {
  scenes::PointPair pair{scenes::lens(2 * m, 0.5), scenes::lens(2 * m, 0.5), Pose(), Pose()};
  pair.pose_a = *Pose::from_quaternion({std::sqrt(0.5), 0.001, 0.0007, std::sqrt(0.5)}, Vec3(0.01, 0.02, 0.03));
  return Bodies(pair);
}

TEST(Decomposition, HoldsEveryEdgeEdgeFacetAndNoOtherPair) {
  Scratch scratch;
  std::int64_t facets = 0;
  for (int f = 0; f < scenes::kPairFamilies; ++f) {
    for (int round = 0; round < 12; ++round) {
      const auto family = static_cast<scenes::PairFamily>(f);
      const auto depth = static_cast<scenes::DepthClass>(round % scenes::kDepthClasses);
      const int n = round < 8 ? 8 : 24;
      SCOPED_TRACE(std::string(scenes::to_string(family)) + " round " + std::to_string(round));
      const Bodies bodies(scenes::make_pair(family, n, depth, 100 + static_cast<std::uint64_t>(round)));
      const Decomposition family_of_pairs = bodies.decomposed();
      const DecompositionCheck check = bodies.check(family_of_pairs);
      EXPECT_EQ(check.missing, 0);
      EXPECT_EQ(check.extra, 0);
      const DecompositionCover cover = cover_of(family_of_pairs, bodies.a, bodies.b);
      facets += cover.edge_edge;
      // Once in each role; arcs that lie on each other are found in every chart that they pass, too.
      EXPECT_LE(cover.max_cover, 24);
      const ConvexShape a(bodies.a), b(bodies.b);
      const ContactClass contact = penetration_depth({&a, bodies.pose_a}, {&b, bodies.pose_b}, scratch).contact;
      if (contact == ContactClass::separated) continue;
      EXPECT_EQ(check.lines_below, 0);
      if (contact == ContactClass::overlapping) {
        EXPECT_EQ(check.lines_meeting, 0);
      }
    }
  }
  EXPECT_GT(facets, 5000);
}

TEST(Decomposition, SegmentsByHand) {
  // A segment through a unit cube along its diagonal: its great circle crosses the six arcs of the edges that it does
  // not meet at a corner of the cube.
  const ConvexPolytope box = *ConvexPolytope::box({1, 1, 1});
  const ConvexPolytope diagonal = *ConvexPolytope::from_points(std::vector<Vec3>{{-1, -1, -1}, {1, 1, 1}});
  const Decomposition f = Decomposition::of(diagonal, Pose(), box, Pose());
  EXPECT_EQ(cover_of(f, diagonal, box).edge_edge, 6);
  EXPECT_EQ(check_decomposition(f, diagonal, Pose(), box, Pose(), kLimit)->missing, 0);
  EXPECT_EQ(cover_of(Decomposition::of(diagonal, Pose(), diagonal, Pose()), diagonal, diagonal).edge_edge, 0);
}

TEST(Decomposition, QuadraticManyFacetsInNearLinearSpace) {
  for (const int m : {32, 64, 128, 256}) {
    const Bodies bodies = crossed_lenses(m);
    const Decomposition f = bodies.decomposed();
    const DecompositionCheck check = bodies.check(f);
    EXPECT_EQ(check.missing, 0);
    EXPECT_EQ(check.extra, 0);
    const DecompositionCover cover = cover_of(f, bodies.a, bodies.b);
    EXPECT_GE(cover.edge_edge, m * m / 2);
    EXPECT_LE(cover.max_cover, 2);
    const double edges = bodies.a.num_edges() + bodies.b.num_edges();
    const double log = std::log2(edges);
    EXPECT_LE(static_cast<double>(f.sum_sizes()), edges * log * log);  // equation (1)
    EXPECT_LE(f.sum_products(), 2 * cover.edge_edge);
    for (const Decomposition::SizeClass& c : f.size_classes()) {  // (C5), its constants measured
      const double canonical = c.family == Decomposition::Family::a ? bodies.a.num_edges() : bodies.b.num_edges();
      EXPECT_LE(static_cast<double>(c.pairs), 4 * canonical / std::exp2(c.exponent) * log + 1);
      EXPECT_LE(static_cast<double>(c.opposite_sum), 4 * edges * log);
    }
    EXPECT_LE(f.closest_lines_work(), 4 * std::sqrt(static_cast<double>(cover.edge_edge)) * std::sqrt(edges * log));
  }
}

TEST(Decomposition, CanonicalSetsAreStacksAndTheCheckCanFail) {
  const Bodies bodies = crossed_lenses(32);
  const Bodies moved = [&] {
    Bodies other = bodies;
    other.pose_a = *Pose::from_quaternion({0.7, 0.1, 0.1, 0.7}, Vec3::Zero());
    return other;
  }();
  // F of other poses: some of its pairs do not cross here, and some crossings are missing.
  const DecompositionCheck check = bodies.check(moved.decomposed());
  EXPECT_GT(check.missing, 0);
  EXPECT_GT(check.extra, 0);
  EXPECT_EQ(check_decomposition(moved.decomposed(), bodies.a, bodies.pose_a, bodies.b, bodies.pose_b, 10).error().code,
            ErrorCode::limit_exceeded);
}

}  // namespace
}  // namespace pd
