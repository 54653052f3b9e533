// Places of zero area where Q fits exactly: told at a placement, and listed, each once.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "pd/planar/convex_polygon.hpp"
#include "pd/planar/polygon_depth.hpp"
#include "planar/polygon_oracle.hpp"
#include "planar/small_polygons.hpp"

namespace {

using oracle::Rings;
using oracle::Vec;
using pd::Point2;
using pd::PolygonDifference;
using pd::PolygonMethod;
using pd::test::made;
using pd::test::SmallPolygons;
using pd::test::text;
using Slot = std::array<Point2, 2>;

Rings frame_with(const std::vector<std::vector<Vec>>& holes, double side) {
  Rings rings = {{{0, 0}, {side, 0}, {side, side}, {0, side}}};
  rings.insert(rings.end(), holes.begin(), holes.end());
  return rings;
}

PolygonDifference::Seats seats(const Rings& p, const Rings& q, PolygonMethod method) {
  return PolygonDifference::of(made(p), made(q), method)->seats();
}

TEST(Seats, EachIsListedOnce) {
  const Rings square = {{{0, 0}, {2, 0}, {2, 2}, {0, 2}}}, bar = {{{0, 0}, {1, 0}, {1, 3}, {0, 3}}};
  const Rings plate = frame_with({{{1, 1}, {3, 1}, {3, 3}, {1, 3}},       // fits the square
                                  {{4, 1}, {6, 1}, {6, 7}, {4, 7}},       // a slot of the square
                                  {{1, 4}, {3.5, 4}, {3.5, 9}, {1, 9}}},  // room
                                 10);
  for (const PolygonMethod method : {PolygonMethod::implicit, PolygonMethod::explicit_sums}) {
    const auto found = seats(plate, square, method);
    EXPECT_EQ(found.points, (std::vector<Point2>{{1, 1}}));
    EXPECT_EQ(found.slots, (std::vector<Slot>{{{{4, 1}, {4, 5}}}}));
    EXPECT_TRUE(seats(plate, bar, method).points.empty());
    // Held by three vertices in the middles of three edges.
    const auto wedged = seats(frame_with({{{2, 2}, {6, 2}, {2, 6}}}, 8), {{{2, 0}, {2, 2}, {0, 2}}}, method);
    EXPECT_EQ(wedged.points, (std::vector<Point2>{{2, 2}}));
  }
  // The moving one has the hole: what it holds fits at the opposite displacement.
  const auto turned = seats(square, plate, PolygonMethod::implicit);
  EXPECT_EQ(turned.points, (std::vector<Point2>{{-1, -1}}));
  EXPECT_EQ(turned.slots, (std::vector<Slot>{{{{-4, -5}, {-4, -1}}}}));
  // A star with three spikes reaches into the corners of the hole: vertex meets vertex.
  const auto star = seats(frame_with({{{1, 1}, {7, 1}, {1, 7}}}, 8), {{{1, 1}, {3, 2}, {7, 1}, {3, 3}, {1, 7}, {2, 3}}},
                          PolygonMethod::automatic);
  EXPECT_EQ(star.points, (std::vector<Point2>{{0, 0}}));
}

double distance(const Slot& slot, const Point2& y) {
  const double dx = slot[1][0] - slot[0][0], dy = slot[1][1] - slot[0][1];
  const double s = std::clamp(((y[0] - slot[0][0]) * dx + (y[1] - slot[0][1]) * dy) / (dx * dx + dy * dy), 0.0, 1.0);
  return std::hypot(slot[0][0] + s * dx - y[0], slot[0][1] + s * dy - y[1]);
}

/// @return how many seats there were.
int judge(const Rings& p, const Rings& q, PolygonMethod method) {
  const PolygonDifference r = *PolygonDifference::of(made(p), made(q), method);
  const oracle::PolygonOracle truth(p, q);
  const PolygonDifference::Seats found = r.seats();
  const std::string what = "p " + text(p) + " q " + text(q);
  const auto on_slot = [&](const Point2& y) {
    return std::any_of(found.slots.begin(), found.slots.end(), [&](const Slot& s) { return distance(s, y) < 1e-9; });
  };
  const auto is_point = [&](const Point2& y) {
    return std::any_of(found.points.begin(), found.points.end(),
                       [&](const Point2& x) { return std::hypot(x[0] - y[0], x[1] - y[1]) < 1e-9; });
  };
  int at_places = 0;
  for (const Vec& x : truth.seats()) {
    EXPECT_TRUE(is_point(x) || on_slot(x)) << what << x[0] << "," << x[1];
    ++at_places;
  }
  for (const Point2& x : found.points) {
    EXPECT_TRUE(!truth.overlap(x) && truth.interior(x) && !on_slot(x)) << what << x[0] << "," << x[1];
  }
  for (const Slot& s : found.slots) {
    const Point2 middle = {0.5 * s[0][0] + 0.5 * s[1][0], 0.5 * s[0][1] + 0.5 * s[1][1]};
    EXPECT_TRUE(!truth.overlap(middle) && truth.interior(middle)) << what << middle[0] << "," << middle[1];
    EXPECT_LT(s[0], s[1]);
    for (const Slot& t : found.slots) EXPECT_TRUE(&t == &s || distance(t, middle) > 1e-9) << what;
  }
  for (double x = -2; x <= 6; x += 0.5) {
    for (double y = -2; y <= 6; y += 0.5) {
      // A slot's end may lie on the boundary of the regularised R: that touches.
      const bool listed = is_point({x, y}) || (on_slot({x, y}) && r.contact({x, y}) != pd::PlanarContact::touching);
      EXPECT_EQ(r.seat({x, y}), listed) << what << x << "," << y;
    }
  }
  return at_places;
}

/// A frame with a hole of Q's shape, drawn out along a vector.
Rings frame_for(const Rings& q, SmallPolygons& next) {
  const double out_x = next.whole(-1, 1), out_y = next.whole(0, 1);
  const int way = next.whole(0, 2);
  std::vector<Point2> points;
  for (const Vec& x : q[0]) {
    points.push_back({x[0] + 2, x[1] + 2});
    if (way > 0) points.push_back({x[0] + 2 + out_x, x[1] + 2 + out_y});
  }
  const pd::ConvexPolygon hull = *pd::ConvexPolygon::from_points(points);
  std::vector<Vec> hole;
  for (int i = 0; i < hull.num_vertices(); ++i) hole.push_back(hull.vertex(i));
  if (way == 2) hole[static_cast<std::size_t>(next.whole(0, static_cast<int>(hole.size()) - 1))][0] += 1;
  return frame_with({hole}, 9);
}

TEST(Seats, AgainstTheOracle) {
  SmallPolygons next(4242);
  int seen = 0;
  for (int i = 0; i < pd::test::planar_cases(60) && !HasFailure(); ++i) {
    const Rings q = next.convex(5, 3);
    const Rings p = frame_for(q, next);
    const bool valid =
        pd::Polygon::from_rings(p[0], std::vector<std::vector<Point2>>(p.begin() + 1, p.end())).has_value();
    if (!valid) continue;
    seen += judge(p, q, i % 3 == 0 ? PolygonMethod::explicit_sums : PolygonMethod::implicit);
  }
  EXPECT_GT(seen, pd::test::planar_cases(60) / 3);
  for (int i = 0; i < pd::test::planar_cases(60) / 3 && !HasFailure(); ++i) {
    (void)judge(next.touching(5), i % 2 == 0 ? next.convex(4, 2) : next.simple(5, 2, false), PolygonMethod::automatic);
  }
}

}  // namespace
