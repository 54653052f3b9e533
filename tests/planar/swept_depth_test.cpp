// Polygons swept by discs, and discs: analytic cases, convex pairs exactly, the others between polygons that the disc
// covers and that cover it.
#include <gtest/gtest.h>

#include <cmath>

#include "pd/planar/convex_polygon.hpp"
#include "pd/planar/polygon_depth.hpp"
#include "planar/small_polygons.hpp"

namespace {

using oracle::Rings;
using pd::ErrorCode;
using pd::Leave;
using pd::PlanarContact;
using pd::PlanarMargins;
using pd::Point2;
using pd::Polygon;
using pd::PolygonDepth;
using pd::PolygonDifference;
using pd::test::made;
using pd::test::SmallPolygons;
using pd::test::text;

const Rings kSquare = {{{0, 0}, {4, 0}, {4, 4}, {0, 4}}};

TEST(SweptDepth, TwoDiscs) {
  const Polygon a = *Polygon::at_point({1, 1}), b = *Polygon::at_point({0, 0});
  const auto r = *PolygonDifference::of(a, b);
  const PolygonDepth deep = *r.swept_depth({4, 5}, {4, 3});  // the centres are 5 apart
  EXPECT_EQ(deep.contact, PlanarContact::overlapping);
  EXPECT_EQ(deep.depth, 2);
  EXPECT_NEAR(deep.translation[0], 1.2, 1e-15);
  EXPECT_NEAR(deep.translation[1], 1.6, 1e-15);
  EXPECT_EQ(r.swept_depth({4, 5}, {4, 1})->contact, PlanarContact::touching);
  EXPECT_EQ(r.swept_depth({4, 5}, {2, 1})->contact, PlanarContact::separated);
  EXPECT_EQ(r.swept_depth({1, 1}, {2, 1})->depth, 3);
  EXPECT_NEAR(r.swept_depth_along({1, 1}, {0, -1}, {2, 1})->depth, 3, 1e-9);
  EXPECT_EQ(r.contact({1, 1}), PlanarContact::separated);  // points have no inside
}

TEST(SweptDepth, ADiscAndASquare) {
  const Polygon disc = *Polygon::at_point({0, 0});
  for (const bool turned : {false, true}) {
    const auto r = *PolygonDifference::of(turned ? disc : made(kSquare), turned ? made(kSquare) : disc);
    const auto at = [&](double x, double y) { return turned ? Point2{-x, -y} : Point2{x, y}; };
    const PlanarMargins margins = turned ? PlanarMargins{2, 0} : PlanarMargins{0, 2};
    EXPECT_EQ(r.swept_depth(at(1, 2), margins)->depth, 3);
    EXPECT_EQ(r.swept_depth(at(5, 2), margins)->depth, 1);
    EXPECT_EQ(r.swept_depth(at(5, 2), margins)->translation, at(1, 0));
    EXPECT_EQ(r.swept_depth(at(4, 2), margins)->depth, 2);                            // the centre on the edge
    EXPECT_NEAR(r.swept_depth(at(5, 5), margins)->depth, 2 - std::sqrt(2.0), 1e-15);  // beyond a corner
    EXPECT_EQ(r.swept_depth(at(6, 2), margins)->contact, PlanarContact::touching);
    EXPECT_EQ(r.swept_depth(at(6, 6), margins)->contact, PlanarContact::separated);
    EXPECT_NEAR(r.swept_depth_along(at(2, 2), at(0, 1), margins)->depth, 4, 1e-9);
    EXPECT_EQ(r.swept_depth(at(1, 2), margins, Leave::escape)->depth, 3);
    EXPECT_NEAR(r.swept_depth_along(at(-9, 2), at(1, 0), margins, Leave::straight)->depth, 15, 1e-9);
  }
}

TEST(SweptDepth, AReflexCornerHoldsADiscAwayFromIt) {
  // A notch at (2, 2) with a right angle: the disc of radius 1 comes to rest at (3, 3).
  const Rings bracket = {{{0, 0}, {6, 0}, {6, 2}, {2, 2}, {2, 6}, {0, 6}}};
  const auto r = *PolygonDifference::of(made(bracket), *Polygon::at_point({0, 0}));
  const PolygonDepth answer = *r.swept_depth({1.75, 1.75}, {0, 1});
  EXPECT_NEAR(answer.depth, std::sqrt(2.0) * 1.25, 1e-5);
  EXPECT_LE(answer.lower, std::sqrt(2.0) * 1.25);
  EXPECT_GE(answer.upper, std::sqrt(2.0) * 1.25);
  EXPECT_LE(answer.upper - answer.lower, 1.01e-6 * answer.upper);
  EXPECT_EQ(r.swept_depth({3, 3}, {0, 1})->contact, PlanarContact::touching);
  EXPECT_NEAR(r.swept_depth({1, 5}, {0, 1})->depth, 2, 1e-9);
}

TEST(SweptDepth, ConvexPairsAreExact) {
  SmallPolygons next(88);
  int overlapping = 0;
  for (int i = 0; i < pd::test::planar_cases(200); ++i) {
    const auto r = *PolygonDifference::of(made(next.convex(6, 8)), made(next.convex(5, 5)));
    const Point2 y = {next.eighths(-8, 12), next.eighths(-8, 12)};
    const PlanarMargins margins = {next.whole(0, 8) / 4.0, next.whole(1, 8) / 4.0};
    const double radius = margins.p + margins.q;
    const PolygonDepth bare = r.depth(y), swept = *r.swept_depth(y, margins);
    EXPECT_TRUE(swept.upper == swept.lower || swept.upper == std::nextafter(swept.lower, 1e300));
    if (bare.contact == PlanarContact::overlapping) {
      EXPECT_NEAR(swept.depth, bare.depth + radius, 1e-14 * swept.depth);
      ++overlapping;
    }
    if (swept.contact != PlanarContact::overlapping) continue;
    const Point2 there = {y[0] + swept.translation[0], y[1] + swept.translation[1]};
    EXPECT_LE(r.swept_depth(there, margins)->depth, 1e-14 * (1 + radius));
    EXPECT_NEAR(r.swept_depth_along(y, swept.normal, margins)->depth, swept.depth, 1e-8 * swept.depth);
  }
  EXPECT_GT(overlapping, pd::test::planar_cases(200) / 20);
}

/// The disc of radius r about each corner of a convex polygon, as a polygon of 96 corners: inside, or around it.
Rings rounded(const Rings& polygon, double r, bool around) {
  constexpr int kCorners = 96;
  std::vector<Point2> points;
  for (const auto& x : polygon[0]) {
    for (int k = 0; k < kCorners; ++k) {
      const double angle = 2 * M_PI * (k + 0.5) / kCorners;
      const double reach = around ? r / std::cos(M_PI / kCorners) * (1 + 1e-12) : r * (1 - 1e-12);
      points.push_back({x[0] + reach * std::cos(angle), x[1] + reach * std::sin(angle)});
    }
  }
  const pd::ConvexPolygon hull = *pd::ConvexPolygon::from_points(points);
  Rings ring(1);
  for (int v = 0; v < hull.num_vertices(); ++v) ring[0].push_back(hull.vertex(v));
  return ring;
}

TEST(SweptDepth, LiesBetweenPolygonsInsideTheDiscAndAroundIt) {
  SmallPolygons next(89);
  int overlapping = 0, wide = 0;
  for (int i = 0; i < pd::test::planar_cases(25); ++i) {
    const Rings p = i % 3 == 0 ? next.touching(6) : next.simple(8, 7, true), q = next.convex(4, 3);
    const double radius = next.whole(1, 12) / 8.0;
    const auto r = *PolygonDifference::of(made(p), made(q));
    const auto inner = *PolygonDifference::of(made(p), made(rounded(q, radius, false)));
    const auto outer = *PolygonDifference::of(made(p), made(rounded(q, radius, true)));
    for (int k = 0; k < 4; ++k) {
      const Point2 y = {next.eighths(-1, 6), next.eighths(-1, 6)};
      const Point2 d = {double(next.whole(-3, 3)), double(next.whole(1, 3))};
      const std::string what = text(p) + " q " + text(q) + " r " + std::to_string(radius) + " y " +
                               std::to_string(y[0]) + "," + std::to_string(y[1]);
      const PolygonDepth answer = *r.swept_depth(y, {radius, 0});
      ASSERT_GE(answer.upper * (1 + 1e-9) + 1e-9, inner.depth(y).depth) << what;
      ASSERT_LE(answer.lower * (1 - 1e-9) - 1e-9, outer.depth(y).depth) << what;
      ASSERT_LE(answer.lower, answer.upper) << what;
      wide += answer.upper - answer.lower > 1.01e-6 * answer.upper ? 1 : 0;
      overlapping += answer.contact == PlanarContact::overlapping ? 1 : 0;
      for (const Leave leave : {Leave::first_exit, Leave::straight}) {
        const PolygonDepth along = *r.swept_depth_along(y, d, {0, radius}, leave);
        ASSERT_GE(along.upper * (1 + 1e-9) + 1e-9, inner.depth_along(y, d, leave).depth) << what;
        ASSERT_LE(along.lower * (1 - 1e-9) - 1e-9, outer.depth_along(y, d, leave).depth) << what;
        ASSERT_LE(along.lower, along.upper);
      }
    }
  }
  EXPECT_GT(overlapping, pd::test::planar_cases(25));
  EXPECT_LE(wide, pd::test::planar_cases(25) / 100);  // ended at the limit of boxes
}

void expect_around(const PolygonDepth& answer, double known, double width) {
  EXPECT_LE(answer.lower, known + 1e-12);
  EXPECT_GE(answer.upper, known - 1e-12);
  EXPECT_LE(answer.upper - answer.lower, width);
}

/// A disc in a room with a door in the wall on the right, which begins at x = 10; the walls are 1 thick.
TEST(SweptDepth, ADiscLeavesARoomForGood) {
  const auto room = [](double half_door) {
    return Rings{{{0, 0},
                  {11, 0},
                  {11, 5 - half_door},
                  {10, 5 - half_door},
                  {10, 1},
                  {1, 1},
                  {1, 9},
                  {10, 9},
                  {10, 5 + half_door},
                  {11, 5 + half_door},
                  {11, 10},
                  {0, 10}}};
  };
  const Polygon disc = *Polygon::at_point({0, 0});
  for (const bool turned : {false, true}) {
    const auto at = [&](double x, double y) { return turned ? Point2{-x, -y} : Point2{x, y}; };
    const auto difference = [&](double half_door) {
      const Polygon walls = made(room(half_door));
      return *PolygonDifference::of(turned ? disc : walls, turned ? walls : disc);
    };
    const PlanarMargins margins = turned ? PlanarMargins{0.75, 0.25} : PlanarMargins{0, 1};
    // The disc fits through the wider door, so that it is free, and goes straight out in front of it alone.
    const auto wide = difference(1.1), narrow = difference(0.9);
    EXPECT_EQ(wide.swept_depth(at(3, 3), margins, Leave::escape)->upper, 0);
    EXPECT_EQ(wide.swept_depth(at(3, 5), margins, Leave::straight)->upper, 0);
    EXPECT_EQ(wide.swept_depth_along(at(3, 3), at(1, 0), margins, Leave::escape)->upper, 0);
    const PolygonDepth straight = *wide.swept_depth(at(3, 3), margins, Leave::straight);
    EXPECT_GT(straight.lower, 1);
    EXPECT_LE(straight.upper, 4 + 1e-9) << "through the wall on the left, or below";
    // The narrow door holds the disc: it leaves through the wall, 3 + 1 away, or 4.5 + 1 in front of the door.
    for (const Leave leave : {Leave::escape, Leave::straight}) {
      const PolygonDepth out = *narrow.swept_depth(at(3, 3), margins, leave);
      EXPECT_EQ(out.contact, PlanarContact::separated);
      expect_around(out, 4, 1e-6);
      expect_around(*narrow.swept_depth_along(at(3, 3), at(1, 0), margins, leave), 9, 1e-6);
    }
    // Stuck in the door: the corners are 0.9 above and below, and the centre at x = 11 + sqrt(1 - 0.81) is free.
    const PolygonDepth door = *narrow.swept_depth(at(11, 5), margins, Leave::escape);
    EXPECT_EQ(door.contact, PlanarContact::overlapping);
    expect_around(door, std::sqrt(1 - 0.81), 1e-6);
    const Point2 out = {11 + (turned ? -1 : 1) * door.translation[0], 5 + (turned ? -1 : 1) * door.translation[1]};
    EXPECT_LE(narrow.swept_depth(at(out[0], out[1]), margins)->depth, 1e-12);
  }
}

/// Between the ways out of Q swept by polygons inside the disc and around it.
TEST(SweptDepth, WaysOutForGoodLieBetweenPolygonsToo) {
  SmallPolygons next(90);
  int wide = 0, held = 0;
  const int cases = pd::test::planar_cases(8);
  for (int i = 0; i < cases; ++i) {
    const Rings p = i % 3 == 0 ? next.touching(6) : next.simple(8, 7, true), q = next.convex(4, 3);
    const double radius = next.whole(1, 6) / 8.0;
    const auto r = *PolygonDifference::of(made(p), made(q));
    const auto inner = *PolygonDifference::of(made(p), made(rounded(q, radius, false)));
    const auto outer = *PolygonDifference::of(made(p), made(rounded(q, radius, true)));
    for (int k = 0; k < 4; ++k) {
      const Point2 y = {next.eighths(-1, 6), next.eighths(-1, 6)};
      const Point2 d = {double(next.whole(-3, 3)), double(next.whole(1, 3))};
      const auto expect_between = [&](const PolygonDepth& answer, const PolygonDepth& least, const PolygonDepth& most) {
        const std::string what = text(p) + " q " + text(q) + " r " + std::to_string(radius) + " y " +
                                 std::to_string(y[0]) + "," + std::to_string(y[1]);
        ASSERT_GE(answer.upper * (1 + 1e-9) + 1e-9, least.depth) << what;
        ASSERT_LE(answer.lower * (1 - 1e-9) - 1e-9, most.depth) << what;
        ASSERT_LE(answer.lower, answer.upper) << what;
        wide += answer.upper - answer.lower > 1e-5 * radius ? 1 : 0;
        held += answer.lower > 0 ? 1 : 0;
      };
      const PlanarMargins margins = {radius, 0};
      expect_between(*r.swept_depth(y, margins, Leave::escape), inner.escape_depth(y), outer.escape_depth(y));
      expect_between(*r.swept_depth(y, margins, Leave::straight), inner.straight_escape_depth(y),
                     outer.straight_escape_depth(y));
      expect_between(*r.swept_depth_along(y, d, margins, Leave::escape), inner.depth_along(y, d, Leave::escape),
                     outer.depth_along(y, d, Leave::escape));
    }
  }
  EXPECT_GT(held, 2 * cases);
  EXPECT_LE(wide, cases / 8 + 1) << "passages as wide as Q";
}

TEST(SweptDepth, DirectionsOfAnyLength) {
  const auto r = *PolygonDifference::of(made({{{0, 0}, {3, 0}, {3, 1}, {1, 1}, {1, 3}, {0, 3}}}),
                                        made({{{0, 0}, {1, 0}, {1, 1}, {0, 1}}}));
  const PlanarMargins margins{0.1, 0.1};
  for (const Leave leave : {Leave::first_exit, Leave::straight, Leave::escape}) {
    const PolygonDepth one = *r.swept_depth_along({0.3, 0.2}, {1, 1}, margins, leave);
    for (const double size : {5e-324, 0x1p-1030, 1e-300, 1e300}) {
      const PolygonDepth other = *r.swept_depth_along({0.3, 0.2}, {size, size}, margins, leave);
      EXPECT_NEAR(other.depth, one.depth, 1e-9) << size;
      EXPECT_NEAR(other.normal[0], std::sqrt(0.5), 1e-9) << size;
      EXPECT_NEAR(other.normal[1], std::sqrt(0.5), 1e-9) << size;
      EXPECT_LE(other.lower, one.upper);
      EXPECT_GE(other.upper, one.lower);
    }
  }
}

TEST(SweptDepth, RefusedPlacementsAndDirections) {
  const auto r = *PolygonDifference::of(made({{{0, 0}, {4, 0}, {4, 4}, {3, 1}}}), made(kSquare));
  const double nan = std::nan("");
  const PlanarMargins margins{0.1, 0.1};
  for (const Leave leave : {Leave::first_exit, Leave::straight, Leave::escape}) {
    for (const Point2& placement : {Point2{nan, 0}, Point2{0, HUGE_VAL}}) {
      EXPECT_EQ(r.swept_depth(placement, margins, leave).error().code, ErrorCode::non_finite);
      EXPECT_EQ(r.swept_depth_along(placement, {1, 0}, margins, leave).error().where, "placement");
    }
    for (const Point2& direction : {Point2{nan, 0}, Point2{0, HUGE_VAL}}) {
      EXPECT_EQ(r.swept_depth_along({0, 0}, direction, margins, leave).error().code, ErrorCode::non_finite);
    }
    EXPECT_EQ(r.swept_depth_along({0, 0}, {0, 0}, margins, leave).error().code, ErrorCode::zero_direction);
    EXPECT_EQ(r.swept_depth({1e301, 0}, margins, leave).error().code, ErrorCode::out_of_range);
    // Far away the disc is not asked for.
    EXPECT_EQ(r.swept_depth({1e300, 1e300}, margins, leave)->contact, PlanarContact::separated);
    EXPECT_EQ(r.swept_depth({1e300, 1e300}, margins, leave)->depth, 0);
  }
  EXPECT_EQ(r.swept_depth({0, 0}, {0.1, 1e300}, Leave::escape).error().where, "q.margin");
  EXPECT_EQ(r.swept_depth({0, 0}, {1e300, 0.1}, Leave::straight).error().where, "p.margin");
}

TEST(SweptDepth, Refusals) {
  const auto r = *PolygonDifference::of(made({{{0, 0}, {4, 0}, {4, 4}, {3, 1}}}), made(kSquare));
  EXPECT_EQ(r.swept_depth({0, 0}, {-1, 0}).error().code, ErrorCode::bad_value);
  EXPECT_EQ(r.swept_depth({0, 0}, {0, std::nan("")}).error().where, "q.margin");
  const Polygon kite = made({{{0, 0}, {4, 0}, {4, 4}, {3, 1}}});
  const auto kites = *PolygonDifference::of(kite, kite);
  EXPECT_EQ(kites.swept_depth({0, 0}, {1, 0}, Leave::escape).error().code, ErrorCode::unsupported);
  EXPECT_EQ(kites.swept_depth({0, 0}, {1, 0}, Leave::straight).error().where, "complete");
  EXPECT_EQ(kites.swept_depth_along({0, 0}, {1, 0}, {1, 0}, Leave::escape).error().where, "complete");
  EXPECT_EQ(
      PolygonDifference::of(*Polygon::at_point({0, 0}), made(kSquare), pd::PolygonMethod::explicit_sums).error().code,
      ErrorCode::unsupported);
  EXPECT_EQ(Polygon::at_point({std::nan(""), 0}).error().code, ErrorCode::non_finite);
}

}  // namespace
