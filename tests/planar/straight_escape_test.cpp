// The least way straight out over all directions: by hand, against an oracle that tries everything, and laws.
#include <gtest/gtest.h>

#include <cmath>

#include "pd/planar/polygon_depth.hpp"
#include "planar/polygon_oracle.hpp"
#include "planar/small_polygons.hpp"
#include "scenes/polygon_families.hpp"

namespace {

using pd::Leave;
using pd::PlanarContact;
using pd::Point2;
using pd::PolygonDepth;
using pd::PolygonDifference;
using pd::PolygonMethod;
using pd::test::made;
using pd::test::SmallPolygons;
using pd::test::text;

const oracle::Rings kUnit = {{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};

TEST(StraightEscape, OutOfAPocketByItsMouth) {
  // A cup 10 wide, its room from 3 to 7, open above; a unit square in it has 3 of room on either side.
  const oracle::Rings cup = {{{0, 0}, {10, 0}, {10, 9}, {7, 9}, {7, 3}, {3, 3}, {3, 9}, {0, 9}}};
  const auto r = PolygonDifference::of(made(cup), made(kUnit)).value();
  EXPECT_EQ(r.straight_escape_depth({4, 5}).depth, 0);  // straight up
  EXPECT_EQ(r.straight_escape_depth({4, 5}).contact, PlanarContact::separated);
  const PolygonDepth below = r.straight_escape_depth({4, 2.5});
  EXPECT_EQ(below.depth, 0.5);  // up, through the floor into the room
  EXPECT_EQ(below.translation, (Point2{0, 0.5}));
  EXPECT_EQ(below.normal, (Point2{0, 1}));
  // In the wall: into the room is the shorter way (0.25), but from there a straight line leads into the other wall.
  const PolygonDepth wall = r.straight_escape_depth({2.75, 5});
  EXPECT_EQ(r.depth({2.75, 5}).depth, 0.25);
  EXPECT_GT(wall.depth, 0.25);
  EXPECT_LT(wall.depth, 0.5);  // steeply up and along the opposite wall's upper corner
  EXPECT_TRUE(wall.feature.has_value());
}

TEST(StraightEscape, AHoleIsNoWayOut) {
  oracle::Rings frame = {{{0, 0}, {10, 0}, {10, 10}, {0, 10}}};
  frame.push_back({{3, 3}, {3, 7}, {7, 7}, {7, 3}});
  const auto r = PolygonDifference::of(made(frame), made(kUnit)).value();
  EXPECT_EQ(r.straight_escape_depth({4, 4}).depth, 5);  // separated now, but shut in
  EXPECT_EQ(r.straight_escape_depth({4, 4}).contact, PlanarContact::separated);
  EXPECT_EQ(r.straight_escape_depth({2.25, 4}).depth, 3.25);
  EXPECT_EQ(r.straight_escape_depth({11, 4}).depth, 0);
  EXPECT_EQ(r.straight_escape_depth({10, 4}).contact, PlanarContact::touching);
  EXPECT_EQ(r.straight_escape_depth({10, 4}).depth, 0);
}

// A chamber with a mouth between two blocks, one above the other's edge: a unit square below it has one free direction,
// along which it touches both; a little to the left it has none.
TEST(StraightEscape, TheOneDirectionThatSlidesBetween) {
  const oracle::Rings chamber = {
      {{-8, -10}, {8, -10}, {8, 7}, {1, 7}, {1, 5}, {6, 5}, {6, -8}, {-6, -8}, {-6, 0}, {0, 0}, {0, 2}, {-8, 2}}};
  const auto r = PolygonDifference::of(made(chamber), made(kUnit)).value();
  const oracle::PolygonOracle truth(chamber, kUnit);
  EXPECT_EQ(r.straight_escape_depth({0, -3}).depth, 0);
  EXPECT_EQ(r.depth_along({0, -3}, {0, 1}, Leave::straight).depth, 0);
  EXPECT_GT(r.depth_along({0, -3}, {-1, 64}, Leave::straight).depth, 1);
  EXPECT_GT(r.depth_along({0, -3}, {1, 64}, Leave::straight).depth, 1);
  for (const Point2& y : {Point2{-0.125, -3}, Point2{0.125, -3}, Point2{0, -12}}) {
    const double found = r.straight_escape_depth(y).depth;
    EXPECT_NEAR(found, truth.straight_escape(y), 1e-9) << y[0];
    EXPECT_EQ(found, y[0] < 0 ? 5 : 0);  // up through the left block, or to the left through the mouth
  }
}

int judge(const oracle::Rings& p, const oracle::Rings& q, PolygonMethod method, SmallPolygons& next) {
  const auto r = PolygonDifference::of(made(p), made(q), method).value();
  const oracle::PolygonOracle truth(p, q);
  for (int k = 0; k < 3; ++k) {
    const Point2 y = {next.eighths(-2, 6), next.eighths(-2, 6)};
    const PolygonDepth found = r.straight_escape_depth(y);
    const std::string what =
        "p " + text(p) + " q " + text(q) + " y " + std::to_string(y[0]) + "," + std::to_string(y[1]);
    EXPECT_NEAR(found.depth, truth.straight_escape(y), 1e-8) << what;
    EXPECT_EQ(to_string(found.contact), truth.contact(y)) << what;
    EXPECT_LE(found.lower, found.upper);
    EXPECT_TRUE(found.upper == found.lower || found.upper == std::nextafter(found.lower, 1e300)) << what;
    EXPECT_NEAR(std::hypot(found.translation[0], found.translation[1]), found.depth, 1e-15 * (1 + found.depth));
    EXPECT_EQ(found.feature.has_value(), found.depth > 0) << what;
  }
  return 3;
}

TEST(StraightEscape, AgainstTheOracle) {
  SmallPolygons next(31);
  for (int i = 0; i < pd::test::planar_cases(80) && !HasFailure(); ++i) {
    judge(next.simple(6, next.whole(3, 6), i % 4 == 0), next.convex(4, next.whole(1, 4)), PolygonMethod::implicit,
          next);
    if (i % 2 == 0) {
      judge(next.simple(5, 5, false), next.simple(5, next.whole(2, 4), false), PolygonMethod::explicit_sums, next);
    }
  }
}

// No direction is better, and the methods give the same bits.
TEST(StraightEscape, IsTheLeastOverDirections) {
  SmallPolygons next(32);
  for (int i = 0; i < pd::test::planar_cases(150); ++i) {
    const int grid = next.whole(3, 10);
    const oracle::Rings p = next.simple(9, grid, i % 2 == 0), q = next.convex(6, next.whole(1, grid));
    const auto r = PolygonDifference::of(made(p), made(q), PolygonMethod::implicit).value();
    const auto other = PolygonDifference::of(made(p), made(q), PolygonMethod::explicit_sums).value();
    for (int k = 0; k < 4; ++k) {
      const Point2 y = {next.eighths(-1, 6), next.eighths(-1, 6)};
      const PolygonDepth found = r.straight_escape_depth(y), same = other.straight_escape_depth(y);
      const std::string what = "p " + text(p) + " q " + text(q) + " y " + std::to_string(y[0]) + "," +
                               std::to_string(y[1]) + ": " + std::to_string(found.depth);
      ASSERT_TRUE(found.lower == same.lower && found.upper == same.upper && found.translation == same.translation)
          << what << " and " << same.depth;
      ASSERT_GE(found.depth, r.escape_depth(y).depth) << what;
      for (int x = -4; x <= 4; ++x) {
        for (int z = -4; z <= 4; ++z) {
          if (x == 0 && z == 0) continue;
          ASSERT_LE(found.depth, r.depth_along(y, {x / 4.0, z / 3.0}, Leave::straight).depth) << what;
        }
      }
    }
  }
}

TEST(StraightEscape, OutOfStarsAndSpirals) {
  pd::scenes::Random random(4);
  for (const auto& p : {pd::scenes::star_polygon(60, random), pd::scenes::spiral_polygon(150)}) {
    const auto r = PolygonDifference::of(p, pd::scenes::round_polygon(24, 0.05)).value();
    for (int i = 0; i < 20; ++i) {
      const Point2 y = {random.uniform(-1, 1), random.uniform(-1, 1)};
      const double found = r.straight_escape_depth(y).depth;
      double sampled = std::numeric_limits<double>::infinity();
      for (int k = 0; k < 3000; ++k) {
        const pd::scenes::Turn t = pd::scenes::turn(k / 3000.0);
        sampled = std::min(sampled, r.depth_along(y, {t.cosine, t.sine}, Leave::straight).depth);
      }
      ASSERT_LE(found, sampled);
      ASSERT_GE(found, 0.8 * sampled - 0.1) << y[0] << "," << y[1];  // the samples come near it
    }
  }
}

}  // namespace
