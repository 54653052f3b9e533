// Directional depth of placements with long numbers, where roundings are settled in double-double, and among long
// edges side by side, whose boxes are turned; Facts 4.1 and 4.2 as they are counted.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "pd/planar/convex_depth.hpp"
#include "pd/planar/polygon_depth.hpp"
#include "planar/boundary/sum_boundary.hpp"
#include "planar/boundary/turned_boxes.hpp"
#include "planar/rounded_crossing.hpp"
#include "planar/small_polygons.hpp"
#include "scenes/polygon_families.hpp"

namespace {

using pd::PlanarContact;
using pd::Point2;
using pd::Polygon;
using pd::PolygonDifference;
using pd::PolygonMethod;
using pd::scenes::Random;

Point2 direction(Random& random) {
  const pd::scenes::Turn t = pd::scenes::turn(random.uniform());
  return {t.cosine, t.sine};
}

std::vector<Point2> oval(int n, Random& random) {
  std::vector<Point2> points;
  const double turned = random.uniform(), flat = random.uniform(0.2, 1);
  for (int i = 0; i < n; ++i) {
    const pd::scenes::Turn t = pd::scenes::turn((i + random.uniform(0, 0.5)) / n + turned);
    points.push_back({t.cosine, flat * t.sine});
  }
  return points;
}

// The search in object space shares no code with the boundary, and rounds by big numbers alone.
TEST(PolygonRays, ConvexPairsGiveTheBitsOfTheSearchInObjectSpace) {
  Random random(pd::test::wanted_seed(91));
  int overlapping = 0;
  for (int i = 0; i < pd::test::planar_cases(400); ++i) {
    const std::vector<Point2> a = oval(3 + i % 9, random), b = oval(3 + i % 7, random);
    const auto p = pd::ConvexPolygon::from_points(a), q = pd::ConvexPolygon::from_points(b);
    const auto ring_p = Polygon::from_rings(a), ring_q = Polygon::from_rings(b);
    ASSERT_TRUE(p && q && ring_p && ring_q);
    const auto r = PolygonDifference::of(*ring_p, *ring_q, PolygonMethod::implicit).value();
    for (int k = 0; k < 10; ++k) {
      const Point2 y = {random.uniform(-1.5, 1.5), random.uniform(-1.5, 1.5)}, d = direction(random);
      const auto expected = pd::convex_directional_depth(*p, *q, y, d).value();
      const auto found = r.depth_along(y, d);
      ASSERT_EQ(found.contact, expected.contact);
      ASSERT_EQ(found.lower, expected.lower) << i << " " << k;
      ASSERT_EQ(found.upper, expected.upper) << i << " " << k;
      if (found.contact != PlanarContact::overlapping) continue;
      ++overlapping;
      ASSERT_NEAR(std::hypot(found.translation[0], found.translation[1]), found.depth, 4e-16 * found.depth);
      ASSERT_NEAR(found.normal[0] * d[1] - found.normal[1] * d[0], 0, 1e-15);
    }
  }
  EXPECT_GT(overlapping, pd::test::planar_cases(400));
}

TEST(PolygonRays, StarsGiveTheBitsOfExplicitSums) {
  Random random(pd::test::wanted_seed(17));
  for (int i = 0; i < pd::test::planar_cases(400) / 20; ++i) {
    const Polygon p = pd::scenes::star_polygon(40, random), q = pd::scenes::round_polygon(5, i % 2 == 0 ? 0.004 : 0.1);
    const auto a = PolygonDifference::of(p, q, PolygonMethod::implicit).value();
    const auto b = PolygonDifference::of(p, q, PolygonMethod::explicit_sums).value();
    for (int k = 0; k < 100; ++k) {
      const Point2 y = {random.uniform(-1, 1), random.uniform(-1, 1)}, d = direction(random);
      for (const pd::Leave leave : {pd::Leave::first_exit, pd::Leave::straight, pd::Leave::escape}) {
        const auto x = a.depth_along(y, d, leave), z = b.depth_along(y, d, leave);
        const bool same = x.contact == z.contact && x.lower == z.lower && x.upper == z.upper &&
                          x.translation == z.translation && x.normal == z.normal;
        ASSERT_TRUE(same) << i << " " << k << ": " << x.depth << " and " << z.depth;
      }
    }
  }
}

// Every segment that a ray meets is among those visited, whatever the turns of the boxes.
TEST(PolygonRays, TurnedBoxesPassNothingOver) {
  Random random(5);
  for (int i = 0; i < 30; ++i) {
    std::vector<pd::detail::TurnedBoxes::Item> items;
    for (int k = 0; k < (i == 0 ? 4000 : 200); ++k) {  // once so many that boxes wait out of order
      const Point2 a = {random.uniform(-1, 1), random.uniform(-1, 1)}, d = direction(random);
      const double length = i % 3 == 0 ? 0.01 : 1;
      const Point2 b = {a[0] + length * d[0], a[1] + length * (i % 3 == 1 ? 1e-3 : 1) * d[1]};
      items.push_back({{a, a, b, b}, 3});
    }
    const pd::detail::TurnedBoxes boxes(items);
    for (int k = 0; k < 50; ++k) {
      const Point2 y = {random.uniform(-1, 1), random.uniform(-1, 1)};
      constexpr std::array<Point2, 4> kUpright = {{{0, 1}, {-0.0, -1}, {1, -0.0}, {-1, 0}}};
      const Point2 d = k % 5 == 0 ? kUpright[static_cast<std::size_t>(k / 5 % 4)] : direction(random);
      const double limit = k % 2 == 0 ? 0.3 : std::numeric_limits<double>::infinity();
      std::vector<bool> visited(items.size(), false);
      boxes.visit(pd::detail::RoundedRay(y, d), limit,
                  [&](std::int32_t j) { visited[static_cast<std::size_t>(j)] = true; });
      for (std::size_t j = 0; j < items.size(); ++j) {
        const Point2 &a = items[j].corner[0], &b = items[j].corner[3];
        const double ex = b[0] - a[0], ey = b[1] - a[1], ax = a[0] - y[0], ay = a[1] - y[1];
        const double w = d[0] * ey - d[1] * ex, t = (ax * ey - ay * ex) / w, s = (ax * d[1] - ay * d[0]) / w;
        if (t >= 0 && t <= limit && s >= 0 && s <= 1) {
          ASSERT_TRUE(visited[j]);
        }
      }
    }
  }
}

// Ends of edges that cut each other at an angle of 1e-4 are rounded by more than others: taken for unknown, they left
// beams that were longer than they are, and rays looked into nearly a thousand boxes.
TEST(PolygonRays, ALargeStarIsLookedIntoByFewBoxes) {
  Random random(1);
  const int n = 32768;
  const auto p = pd::scenes::star_polygon(n, random), q = pd::scenes::round_polygon(32, 0.3 / n);
  const auto r = PolygonDifference::of(p, q, PolygonMethod::implicit).value();
  std::int64_t most = 0, sum = 0;
  int rays = 0;
  for (int i = 0; i < 1500; ++i) {
    const Point2 y = {random.uniform(-0.8, 0.8), random.uniform(-0.8, 0.8)};
    std::int64_t boxes = 0;
    if (r.depth_along(y, direction(random), pd::Leave::first_exit, &boxes).contact != PlanarContact::overlapping)
      continue;
    ++rays;
    sum += boxes;
    most = std::max(most, boxes);
  }
  EXPECT_GT(rays, 500);
  EXPECT_LT(most, 300);
  EXPECT_LT(static_cast<double>(sum), 75.0 * rays);
}

TEST(PolygonRays, RoundingsInDoubtAreLeftToBigNumbers) {
  using pd::detail::Span;
  const Span ray{{{0, 0}, {0, 0}}, {{0, 0}, {3, 4}}, {}};
  // Depth 5: a short number, whose neighbours no bound can exclude.
  EXPECT_FALSE(pd::detail::rounded_crossing(ray, {3, 4}, {{{3, 0}, {0, 0}}, {{0, 0}, {0, 1}}, {}}).has_value());
  EXPECT_TRUE(pd::detail::rounded_crossing(ray, {1, 4}, {{{3, 0}, {0, 0}}, {{0, 0}, {1, 7}}, {}}).has_value());
  EXPECT_FALSE(pd::detail::rounded_crossing(ray, {1, 4}, {{{0x1p201, 0}, {0, 0}}, {{0, 0}, {1, 7}}, {}}).has_value());
  EXPECT_EQ(pd::detail::rounded_sum(1, 0x1p-53, 0), 1.0);  // a tie: even
  EXPECT_EQ(pd::detail::rounded_sum(1, 0x1p-53, 0x1p-100), 1 + 0x1p-52);
  EXPECT_EQ(pd::detail::rounded_sum(1, 0x1p-80, 0x1p-200), std::nullopt);
}

// [D] Facts 4.1 and 4.2 on families that reach them: crossings come in twos.
TEST(PolygonFacts, AreCountedWhileTheBoundaryIsMade) {
  Random random(3);
  std::int64_t most = 0, crossings = 0;
  for (const double radius : {0.002, 0.05, 0.4}) {
    for (const Polygon& p : {pd::scenes::star_polygon(60, random), pd::scenes::comb_polygon(40),
                             pd::scenes::spiral_polygon(150), pd::scenes::plate_with_holes(4)}) {
      const auto s = PolygonDifference::of(p, pd::scenes::round_polygon(9, radius))->statistics();
      EXPECT_TRUE(s.facts_hold && s.implicit);
      EXPECT_LE(s.most_crossings, 2);
      EXPECT_LE(s.reflex_points, s.reflex_bound);
      EXPECT_EQ(s.reflex_bound, 6 * s.sums - 12);
      EXPECT_GT(s.reflex_points, 0);
      // A reflex point is a crossing of two pieces, but where one vertex of Q lies on both: not at a star's corners.
      if (p.num_vertices() == 60) {
        EXPECT_GE(s.crossings, s.reflex_points);
      }
      most = std::max(most, s.most_crossings);
      crossings += s.crossings;
    }
  }
  EXPECT_EQ(most, 2);
  EXPECT_GT(crossings, 1000);
}

TEST(PolygonFacts, AreJudgedByTheirBounds) {
  pd::detail::BoundaryCounts counts;
  counts.sums = 1;
  EXPECT_TRUE(counts.facts_hold());
  counts.reflex_points = 1;  // of one convex sum
  EXPECT_FALSE(counts.facts_hold());
  counts.sums = 2;
  counts.reflex_points = 2;
  EXPECT_TRUE(counts.facts_hold());
  counts.sums = 5;
  counts.reflex_points = 18;
  counts.most_crossings = 2;
  EXPECT_TRUE(counts.facts_hold());
  counts.reflex_points = 19;
  EXPECT_FALSE(counts.facts_hold());
  counts.reflex_points = 18;
  counts.most_crossings = 3;
  EXPECT_FALSE(counts.facts_hold());
}

}  // namespace
