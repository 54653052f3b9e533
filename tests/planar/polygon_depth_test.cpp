// Polygon depth: analytic cases, every method against an oracle that tries everything, laws, degenerate input.
#include "pd/planar/polygon_depth.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "pd/planar/direction_set.hpp"
#include "planar/polygon_oracle.hpp"
#include "planar/small_polygons.hpp"
#include "scenes/polygon_families.hpp"

namespace {

using pd::Leave;
using pd::PlanarContact;
using pd::Point2;
using pd::Polygon;
using pd::PolygonDepth;
using pd::PolygonDifference;
using pd::PolygonMethod;
using pd::test::SmallPolygons;
using pd::test::text;

oracle::Rings square(double low, double high) { return {{{low, low}, {high, low}, {high, high}, {low, high}}}; }
oracle::Rings frame() {
  oracle::Rings rings = square(0, 10);
  rings.push_back({{3, 3}, {3, 7}, {7, 7}, {7, 3}});
  return rings;
}

void expect_near(double value, const PolygonDepth& answer, const std::string& what) {
  EXPECT_NEAR(answer.depth, value, 1e-8) << what;
  EXPECT_LE(answer.lower, answer.upper);
  EXPECT_TRUE(answer.upper == answer.lower || answer.upper == std::nextafter(answer.lower, 1e300)) << what;
  EXPECT_NEAR(std::hypot(answer.translation[0], answer.translation[1]), answer.depth, 1e-15 * (1 + answer.depth))
      << what;
}

/// One pair, several placements, every question, against the oracle. @return the number of answers compared.
int judge(const oracle::Rings& p, const oracle::Rings& q, SmallPolygons& next, PolygonMethod method, int placements) {
  const PolygonDifference r = *PolygonDifference::of(pd::test::made(p), pd::test::made(q), method);
  const oracle::PolygonOracle truth(p, q);
  int answers = 0;
  for (int i = 0; i < placements; ++i) {
    const Point2 y = {next.eighths(-2, 6), next.eighths(-2, 6)};
    const Point2 d = {double(next.whole(-3, 3)), double(next.whole(1, 3))};
    const std::string what = "p " + text(p) + " q " + text(q) + " y " + std::to_string(y[0]) + "," +
                             std::to_string(y[1]) + " d " + std::to_string(d[0]) + "," + std::to_string(d[1]);
    const PolygonDepth deep = r.depth(y);
    EXPECT_EQ(to_string(deep.contact), truth.contact(y)) << what;
    expect_near(deep.contact == PlanarContact::overlapping ? truth.depth(y) : 0, deep, "depth " + what);
    expect_near(truth.depth_along(y, d), r.depth_along(y, d), "along " + what);
    expect_near(truth.straight_exit(y, d), r.depth_along(y, d, Leave::straight), "straight " + what);
    answers += 4;
  }
  return answers;
}

TEST(PolygonDepth, SquareInASquare) {
  const auto r = *PolygonDifference::of(pd::test::made(square(0, 4)), pd::test::made(square(0, 2)));
  // Q + (1, 1) lies in the middle of the left and lower half: the forbidden placements are the open square (-2, 4)^2.
  const PolygonDepth a = r.depth({0.5, 1});
  EXPECT_EQ(a.contact, PlanarContact::overlapping);
  EXPECT_EQ(a.depth, 2.5);
  EXPECT_EQ(a.translation, (Point2{-2.5, 0}));
  EXPECT_EQ(r.depth_along({1, 1}, {3, 4}).depth, 3.75);
  EXPECT_EQ(r.contact({4, 1}), PlanarContact::touching);
  EXPECT_EQ(r.depth({4, 1}).normal, (Point2{1, 0}));
  EXPECT_EQ(r.contact({std::nextafter(4.0, 5.0), 1}), PlanarContact::separated);
}

TEST(PolygonDepth, AHoleIsAWayOutThatEscapesNowhere) {
  const auto r = *PolygonDifference::of(pd::test::made(frame()), pd::test::made(square(0, 1)));
  EXPECT_EQ(r.statistics().loops, 2);
  EXPECT_EQ(r.contact({4, 4}), PlanarContact::separated);  // in the hole
  const PolygonDepth in = r.depth({2.25, 4});
  EXPECT_EQ(in.depth, 0.75);
  EXPECT_EQ(in.translation, (Point2{0.75, 0}));
  EXPECT_EQ(r.escape_depth({2.25, 4}).depth, 3.25);
  EXPECT_EQ(r.depth_along({2.25, 4}, {1, 0}).depth, 0.75);
  EXPECT_EQ(r.depth_along({2.25, 4}, {1, 0}, Leave::escape).depth, 7.75);
  EXPECT_EQ(r.depth_along({2.25, 4}, {1, 0}, Leave::straight).depth, 7.75);
  EXPECT_EQ(r.escape_depth({4, 4}).depth, 5);
  EXPECT_EQ(r.escape_depth({11, 4}).depth, 0);
}

TEST(PolygonDepth, ASlotOfZeroWidthIsNoWayOut) {
  oracle::Rings rings = square(0, 10);
  rings.push_back({{3, 3}, {3, 7}, {5, 7}, {5, 3}});
  // A square of 2 fits the hole along a segment of placements, one of 3 does not fit; of 1 fits with room.
  const auto r = *PolygonDifference::of(pd::test::made(rings), pd::test::made(square(0, 2)));
  EXPECT_EQ(r.statistics().loops, 1);
  EXPECT_EQ(r.contact({3, 4}), PlanarContact::overlapping);
  EXPECT_EQ(r.depth({3, 4}).depth, 5);
  const PolygonDifference::Seats seats = r.seats();
  EXPECT_TRUE(seats.points.empty());
  ASSERT_EQ(seats.slots.size(), 1u);  // once, and whole
  EXPECT_EQ(seats.slots[0], (std::array<Point2, 2>{{{3, 3}, {3, 5}}}));
  EXPECT_TRUE(r.seat({3, 4}) && r.seat({3, 3}));
  EXPECT_FALSE(r.seat({3, 5.5}) || r.seat({2, 4}));
  EXPECT_TRUE(PolygonDifference::of(pd::test::made(rings), pd::test::made(square(0, 3)))->seats().slots.empty());
  EXPECT_EQ(PolygonDifference::of(pd::test::made(rings), pd::test::made(square(0, 1)))->statistics().loops, 2);
}

TEST(PolygonDepth, StraightOutThroughASlotIsOutAtItsMouth) {
  // A block with a cut of width 2 from the top: a square of 2 that stands below it fits in without room on either side.
  const oracle::Rings block{{{0, 0}, {10, 0}, {10, 10}, {6, 10}, {6, 4}, {4, 4}, {4, 10}, {0, 10}}};
  const auto r = *PolygonDifference::of(pd::test::made(block), pd::test::made(square(0, 2)));
  const oracle::PolygonOracle truth(block, square(0, 2));
  for (const Point2& y : {Point2{4, 1}, Point2{4, 3}}) {
    const Point2 up{0, 1};
    EXPECT_NEAR(truth.straight_exit(y, up), 10 - y[1], 1e-12);
    EXPECT_EQ(r.depth_along(y, up, Leave::straight).depth, 10 - y[1]);
  }
}

TEST(PolygonDepth, ImplicitAgainstTheOracle) {
  SmallPolygons next(20261122);
  int answers = 0;
  for (int i = 0; i < pd::test::planar_cases(300); ++i) {
    const int grid = next.whole(3, 7);
    answers +=
        judge(next.simple(7, grid, i % 3 == 0), next.convex(5, next.whole(1, grid)), next, PolygonMethod::implicit, 3);
    if (HasFailure()) break;
  }
  RecordProperty("answers", answers);
}

TEST(PolygonDepth, ExplicitAgainstTheOracle) {
  SmallPolygons next(7);
  for (int i = 0; i < pd::test::planar_cases(120) && !HasFailure(); ++i) {
    const int grid = next.whole(3, 6);
    judge(next.simple(6, grid, i % 3 == 0), next.simple(6, next.whole(2, grid), false), next,
          PolygonMethod::explicit_sums, 2);
  }
}

TEST(PolygonDepth, TheConvexOneMayBeEither) {
  SmallPolygons next(11);
  for (int i = 0; i < pd::test::planar_cases(100) && !HasFailure(); ++i) {
    judge(next.convex(5, 5), next.simple(6, 5, i % 2 == 0), next, PolygonMethod::automatic, 2);
  }
}

TEST(PolygonDepth, MethodsGiveTheSameBits) {
  SmallPolygons next(3);
  for (int i = 0; i < 10 * pd::test::planar_cases(300); ++i) {
    const int grid = next.whole(3, 12);
    const oracle::Rings rings_p = next.simple(9, grid, i % 2 == 0), rings_q = next.convex(6, next.whole(1, grid));
    const Polygon p = pd::test::made(rings_p), q = pd::test::made(rings_q);
    const auto a = *PolygonDifference::of(p, q, PolygonMethod::implicit);
    const auto b = *PolygonDifference::of(p, q, PolygonMethod::explicit_sums);
    const auto s = a.statistics();
    ASSERT_TRUE(s.facts_hold) << text(rings_p) << " q " << text(rings_q);  // [D] Facts 4.1 and 4.2
    ASSERT_LE(s.most_crossings, 2);
    ASSERT_LE(s.reflex_points, s.reflex_bound);
    for (int k = 0; k < 4; ++k) {
      const Point2 y = {next.eighths(0, 6), next.eighths(0, 6)}, d = {next.eighths(-3, 3), next.eighths(1, 2)};
      for (const auto& [x, z] : {std::pair{a.depth(y), b.depth(y)},
                                 {a.depth_along(y, d), b.depth_along(y, d)},
                                 {a.depth_along(y, d, Leave::straight), b.depth_along(y, d, Leave::straight)}}) {
        const bool same =
            x.contact == z.contact && x.lower == z.lower && x.upper == z.upper && x.translation == z.translation;
        ASSERT_TRUE(same) << text(rings_p) << " q " << text(rings_q) << " y " << y[0] << "," << y[1] << " d " << d[0]
                          << "," << d[1] << ": " << x.depth << " and " << z.depth;
      }
    }
  }
}

// A corner of the boundary touches another piece of it in its middle: the face behind is one of its own.
TEST(PolygonDepth, APinchPartsTwoFaces) {
  const oracle::Rings p = {{{1, 2}, {4, 0}, {6, 8}, {4, 2}, {3, 4}, {5, 7}}};
  const oracle::Rings q = {{{0, 0}, {1, 1}, {1, 2}}};
  for (const PolygonMethod method : {PolygonMethod::implicit, PolygonMethod::explicit_sums}) {
    EXPECT_EQ(PolygonDifference::of(pd::test::made(p), pd::test::made(q), method)->statistics().loops, 2);
  }
}

// The arc at (7, 11) dips into the sum of one triangle on both sides of a vertex of its own that lies outside.
TEST(PolygonDepth, AnArcCoveredOnBothSidesOfAVertex) {
  const oracle::Rings p = {{{11, 0}, {6, 1}, {0, 7}, {3, 7}, {7, 11}, {5, 7}, {7, 1}, {9, 1}}};
  const oracle::Rings q = {{{10, 7}, {9, 9}, {1, 5}, {0, 0}}};
  const auto r = *PolygonDifference::of(pd::test::made(p), pd::test::made(q), PolygonMethod::implicit);
  EXPECT_EQ(r.statistics().loops, 1);
  EXPECT_NEAR(r.depth({1, 0.25}).depth, oracle::PolygonOracle(p, q).depth({1, 0.25}), 1e-12);
}

void expect_scaled(const PolygonDepth& a, const PolygonDepth& b, double scale) {
  ASSERT_EQ(a.contact, b.contact) << scale;
  ASSERT_EQ(a.lower * scale, b.lower) << scale;
  ASSERT_EQ(a.upper * scale, b.upper) << scale;
}

TEST(PolygonDepth, ScalesByPowersOfTwoKeepEveryBit) {
  SmallPolygons next(5);
  for (const double scale : {0x1p-600, 0x1p-30, 0x1p900}) {
    for (int i = 0; i < 60; ++i) {
      const PolygonMethod method = i % 2 == 0 ? PolygonMethod::automatic : PolygonMethod::explicit_sums;
      oracle::Rings p = next.simple(8, 9, true), q = next.convex(5, 4);
      const auto before = *PolygonDifference::of(pd::test::made(p), pd::test::made(q), method);
      for (auto* rings : {&p, &q}) {
        for (auto& ring : *rings) {
          for (auto& x : ring) x = {x[0] * scale, x[1] * scale};
        }
      }
      const auto after = *PolygonDifference::of(pd::test::made(p), pd::test::made(q), method);
      const Point2 y = {next.eighths(0, 6), next.eighths(0, 6)}, scaled = {y[0] * scale, y[1] * scale};
      expect_scaled(before.depth(y), after.depth(scaled), scale);
      for (const Leave leave : {Leave::first_exit, Leave::straight, Leave::escape}) {
        expect_scaled(before.depth_along(y, {3, 1}, leave), after.depth_along(scaled, {3, 1}, leave), scale);
      }
      if (HasFatalFailure()) return;
    }
  }
}

/// Products of such coordinates overflow: no sum may be taken to cover an edge that it does not reach.
TEST(PolygonDepth, AVertexFarAwayHidesNoEdge) {
  const oracle::Rings notched = {{{0, 0}, {2, 0}, {2, 2}, {1, 1}, {0, 2}}};
  for (const Point2 far : {Point2{1e300, 4}, Point2{4, 1e300}, Point2{1e300, 1e300}}) {
    const oracle::Rings kite = {{{0, 0}, {4, 0}, far, {2, 2}, {0, 4}}};
    const auto r = *PolygonDifference::of(pd::test::made(kite), pd::test::made(notched));
    EXPECT_EQ(r.depth({-3, -3}).contact, PlanarContact::separated);
    EXPECT_EQ(r.depth({1, -1}).contact, PlanarContact::overlapping);
    EXPECT_EQ(r.depth({1, -1}).depth, 1) << far[0];  // down, by the lower edges
  }
}

TEST(PolygonDepth, DirectionsOfAnyLengthGiveTheSameBits) {
  SmallPolygons next(6);
  int overlapping = 0;
  for (const double length : {0x1p-1072, 0x1p-1030, 0x1p-500, 0x1p-30, 0x1p990}) {
    for (int i = 0; i < 30; ++i) {
      const auto r = *PolygonDifference::of(pd::test::made(next.simple(8, 9, true)), pd::test::made(next.convex(5, 4)));
      const Point2 y = {next.eighths(0, 6), next.eighths(0, 6)};
      const Point2 d = {double(next.whole(-3, 3)), double(next.whole(1, 3))};
      const Point2 scaled = {d[0] * length, d[1] * length};
      for (const Leave leave : {Leave::first_exit, Leave::straight, Leave::escape}) {
        const PolygonDepth a = r.depth_along(y, d, leave), b = r.depth_along(y, scaled, leave);
        overlapping += a.contact == PlanarContact::overlapping ? 1 : 0;
        ASSERT_EQ(a.contact, b.contact) << length;
        ASSERT_EQ(a.lower, b.lower) << length;
        ASSERT_EQ(a.upper, b.upper) << length;
        ASSERT_EQ(a.translation, b.translation) << length;
      }
      const pd::DirectionSet both = *pd::DirectionSet::of(r, std::array{d, scaled});
      ASSERT_EQ(both.depth(y, 0).contact, both.depth(y, 1).contact) << length;
      ASSERT_EQ(both.depth(y, 0).lower, both.depth(y, 1).lower) << length;
    }
  }
  EXPECT_GT(overlapping, 40);
}

TEST(PolygonDepth, NeitherConvexIsRefusedByTheImplicitMethod) {
  const Polygon f = pd::test::made(frame());
  const auto r = PolygonDifference::of(f, f, PolygonMethod::implicit);
  ASSERT_FALSE(r.has_value());
  EXPECT_EQ(r.error().code, pd::ErrorCode::unsupported);
  EXPECT_EQ(PolygonDifference::of(f, f)->depth({0, 0}).depth, 10);
}

/// Most edges of sums of two convex parts lie inside the whole sum for what is next to them, or for certain under a few
/// sums, and are never cut exactly.
TEST(PolygonDepth, TwoPolygonsOfManyCornersTakeFewCuts) {
  pd::scenes::Random random(5);
  const Polygon comb = pd::scenes::comb_polygon(64), star = pd::scenes::star_polygon(64, random);
  const auto combs = *PolygonDifference::of(comb, comb), stars = *PolygonDifference::of(star, star);
  EXPECT_LT(combs.statistics().pairs, 10 * combs.statistics().sums);
  EXPECT_LT(stars.statistics().pairs, stars.statistics().sums);
  EXPECT_LT(stars.statistics().sums, 62 * 62 * 2 / 3);  // of triangles there would be 62 x 62
}

TEST(PolygonDepth, ExplicitSumsEndByName) {
  pd::scenes::Random random(6);
  const Polygon star = pd::scenes::star_polygon(64, random);
  const auto ended = PolygonDifference::of(star, star, PolygonMethod::automatic, 1000);
  ASSERT_FALSE(ended.has_value());
  EXPECT_EQ(ended.error().code, pd::ErrorCode::limit_exceeded);
  EXPECT_EQ(ended.error().where, "max_comparisons");
  EXPECT_TRUE(PolygonDifference::of(star, star).has_value());
}

/// Parts with many corners, on a lattice where nearly every sign is 0: the same answers as by triangles of one of them.
TEST(PolygonDepth, CombsKeepTheirSlots) {
  const Polygon comb = pd::scenes::comb_polygon(32);
  const auto r = *PolygonDifference::of(comb, comb);
  EXPECT_EQ(r.depth({0, 0}).depth, 11);
  EXPECT_EQ(r.depth({2, 10.5}).depth, 0.5);
  EXPECT_EQ(r.contact({0, 11}), PlanarContact::touching);
  EXPECT_EQ(r.statistics().loops, 1);
}

/// The spine of a comb is one part, with corners inside its side, and of equal sums of teeth one is looked at.
TEST(PolygonDepth, CombsOf512CornersTakeFewComparisons) {
  const Polygon comb = pd::scenes::comb_polygon(512);
  const auto r = PolygonDifference::of(comb, comb, PolygonMethod::automatic, 1 << 21);
  ASSERT_TRUE(r.has_value());
  EXPECT_EQ(r->depth({0, 0}).depth, 11);
  EXPECT_EQ(r->depth({2, 10.5}).depth, 0.5);
  EXPECT_EQ(r->depth({1, 10.5}).depth, 0.5);
  EXPECT_EQ(r->contact({255, 3}), PlanarContact::touching);
}

}  // namespace
