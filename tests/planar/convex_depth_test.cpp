/// @file
/// Convex polygons: differences, depths and classes against all pairs of vertices in integers, the identities of [D]
/// Lemma 2.1 and section 1, and the medial axis against the scan of all edges.
#include "pd/planar/convex_depth.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <set>
#include <vector>

#include "pd/planar/medial_axis.hpp"
#include "planar/small_polygons.hpp"
#include "scenes/shape_families.hpp"

namespace pd {
namespace {

using Integer = __int128;

using test::planar_cases;

ConvexPolygon polygon(const std::vector<Point2>& points) { return *ConvexPolygon::from_points(points); }

std::vector<Point2> grid_points(int n, int range, scenes::Random& random) {
  std::vector<Point2> points;
  for (int i = 0; i < n; ++i) {
    points.push_back({double(random.integer(-range, range)), double(random.integer(-range, range))});
  }
  return points;
}

std::vector<Point2> circle(int n, double phase, double squash = 1) {
  std::vector<Point2> points;
  for (int i = 0; i < n; ++i) {
    const scenes::Turn t = scenes::turn((i + phase) / n);
    points.push_back({t.cosine, squash * t.sine});
  }
  return points;
}

/// By every line through two differences of vertices that has all others on its left.
struct Oracle {
  struct Line {
    std::int64_t x, y, ux, uy;
  };
  std::vector<Line> lines;

  Oracle(const std::vector<Point2>& p, const std::vector<Point2>& q) {
    std::set<std::pair<std::int64_t, std::int64_t>> points;
    for (const Point2& a : p) {
      for (const Point2& b : q) points.insert({std::int64_t(a[0] - b[0]), std::int64_t(a[1] - b[1])});
    }
    for (const auto& [x, y] : points) {
      for (const auto& [z, w] : points) {
        const Line line{x, y, z - x, w - y};
        if (line.ux == 0 && line.uy == 0) continue;
        bool all = true;
        for (const auto& [s, t] : points) all = all && side(line, s, t) >= 0;
        if (all) lines.push_back(line);
      }
    }
  }
  /// By the edges of R in slope order, for polygons of many vertices.
  Oracle(const ConvexPolygon& p, const ConvexPolygon& q) {
    const ConvexDifference r = convex_difference(p, q);
    const auto at = [&](const ConvexDifference::Corner& c, std::size_t k) {
      return std::int64_t(p.vertex(c.p)[k] - q.vertex(c.q)[k]);
    };
    for (std::size_t i = 0; i < r.corners.size(); ++i) {
      const auto &from = r.corners[i], &to = r.corners[(i + 1) % r.corners.size()];
      lines.push_back({at(from, 0), at(from, 1), at(to, 0) - at(from, 0), at(to, 1) - at(from, 1)});
    }
  }
  static std::int64_t side(const Line& l, std::int64_t s, std::int64_t t) {
    return l.ux * (t - l.y) - l.uy * (s - l.x);
  }
  [[nodiscard]] PlanarContact contact(std::int64_t s, std::int64_t t) const {
    PlanarContact contact = PlanarContact::overlapping;
    for (const Line& l : lines) {
      if (side(l, s, t) < 0) return PlanarContact::separated;
      if (side(l, s, t) == 0) contact = PlanarContact::touching;
    }
    return contact;
  }
  /// lower <= min over lines of side / length <= upper, in integers: bounds are doubles with at most 53 bits.
  void check_depth(std::int64_t s, std::int64_t t, const PlanarDepth& found) const {
    long double least = std::numeric_limits<long double>::infinity();
    for (const Line& l : lines) {
      least = std::min(least, (long double)(side(l, s, t)) / std::sqrt((long double)(l.ux * l.ux + l.uy * l.uy)));
    }
    EXPECT_LE((long double)(found.lower), least * (1 + 1e-18L));
    EXPECT_GE((long double)(found.upper), least * (1 - 1e-18L));
  }
  void check_direction(std::int64_t s, std::int64_t t, std::int64_t dx, std::int64_t dy,
                       const PlanarDepth& found) const {
    long double least = std::numeric_limits<long double>::infinity();
    for (const Line& l : lines) {
      const std::int64_t slope = dx * l.uy - dy * l.ux;
      if (slope > 0) least = std::min(least, (long double)(side(l, s, t)) / slope);
    }
    least *= std::sqrt((long double)(dx * dx + dy * dy));
    EXPECT_LE((long double)(found.lower), least * (1 + 1e-18L));
    EXPECT_GE((long double)(found.upper), least * (1 - 1e-18L));
  }
};

TEST(ConvexPolygon, HullsAndRefusals) {
  const ConvexPolygon square = polygon({{1, 1}, {0, 0}, {0.5, 0.5}, {1, 0}, {0, 1}, {0.5, 0}, {0, 0}});
  ASSERT_EQ(square.num_vertices(), 4);
  EXPECT_EQ(square.caller_id(0), 1);
  EXPECT_EQ(square.caller_id(1), 3);
  const auto code = [](const std::vector<Point2>& points) { return ConvexPolygon::from_points(points).error(); };
  EXPECT_EQ(code({}).code, ErrorCode::too_few_points);
  EXPECT_EQ(code({{0, 0}, {1, 1}, {2, 2}}).code, ErrorCode::not_full_dimensional);
  EXPECT_EQ(code({{0, 0}, {1, NAN}, {2, 2}}).code, ErrorCode::non_finite);
  EXPECT_EQ(code({{0, 0}, {1, NAN}, {2, 2}}).where, "points[1]");
  EXPECT_EQ(code({{0, 0}, {1, 0}, {2, 2e300}}).code, ErrorCode::out_of_range);
  EXPECT_EQ(convex_directional_depth(square, square, {0, 0}, {0, 0}).error().code, ErrorCode::zero_direction);
  EXPECT_EQ(convex_directional_depth(square, square, {0, HUGE_VAL}, {0, 1}).error().code, ErrorCode::non_finite);
}

TEST(ConvexPolygon, ExtremeVertices) {
  scenes::Random random(61);
  for (int round = 0; round < 3000; ++round) {
    const auto made = ConvexPolygon::from_points(grid_points(3 + round % 20, 6, random));
    if (!made) continue;
    const Point2 d{double(random.integer(-4, 4)), double(random.integer(-4, 4))};
    if (d[0] == 0 && d[1] == 0) continue;
    const auto value = [&](int i) { return made->vertex(i)[0] * d[0] + made->vertex(i)[1] * d[1]; };
    const int n = made->num_vertices(), found = made->extreme(d);
    for (int i = 0; i < n; ++i) EXPECT_LE(value(i), value(found));
    EXPECT_LT(value((found + n - 1) % n), value(found));
  }
}

TEST(ConvexDepth, AgainstAllPairsOfVertices) {
  scenes::Random random(test::wanted_seed(62));
  int counts[3] = {0, 0, 0};
  for (int round = 0; round < planar_cases(3000) && !HasFailure(); ++round) {
    SCOPED_TRACE(round);
    const int range = round % 3 == 0 ? 3 : 40;
    const auto points_p = grid_points(3 + round % 7, range, random);
    const auto points_q = grid_points(3 + round % 5, range / 2 + 1, random);
    const auto p = ConvexPolygon::from_points(points_p), q = ConvexPolygon::from_points(points_q);
    if (!p || !q) continue;
    const Oracle oracle(points_p, points_q);
    const ConvexDifference difference = convex_difference(*p, *q);
    std::set<std::pair<double, double>> slopes;
    for (const auto& l : oracle.lines) {
      const double size = double(std::gcd(l.ux, l.uy));
      slopes.insert({double(l.ux) / size, double(l.uy) / size});
    }
    EXPECT_EQ(difference.corners.size(), slopes.size());
    const MedialAxis axis = MedialAxis::build(*p, *q);
    EXPECT_EQ(axis.nodes().size() + 2, difference.corners.size());
    for (int i = 0; i < 8; ++i) {
      const int s = random.integer(-range, range), t = random.integer(-range, range);
      int dx = random.integer(-3, 3);
      const int dy = random.integer(-3, 3);
      if (dx == 0 && dy == 0) dx = 1;
      const Point2 y{double(s), double(t)}, d{double(dx), double(dy)};
      const PlanarContact expected = oracle.contact(s, t);
      ++counts[static_cast<int>(expected)];
      EXPECT_EQ(*convex_intersection(*p, *q, y), expected);  // Lemma 2.1
      const PlanarDepth along = *convex_directional_depth(*p, *q, y, d), least = *convex_depth(*p, *q, y);
      const PlanarDepth located = *axis.depth(y);
      ASSERT_EQ(along.contact, expected);
      ASSERT_EQ(least.contact, expected);
      ASSERT_EQ(located.contact, expected);
      if (expected != PlanarContact::overlapping) continue;
      oracle.check_direction(s, t, dx, dy, along);  // equation (1)
      oracle.check_depth(s, t, least);              // equation (2)
      EXPECT_EQ(located.lower, least.lower);
      EXPECT_EQ(located.upper, least.upper);
      EXPECT_LE(std::nextafter(along.lower, HUGE_VAL), std::nextafter(along.upper, HUGE_VAL));
      EXPECT_GE(std::nextafter(along.lower, HUGE_VAL), along.upper);
      // The fused edges are those of the difference.
      const auto& e = along.edge;
      bool listed = false;
      for (const auto& c : difference.corners) {
        listed = listed || (c.p == e.vertex_p && c.q == e.vertex_q && c.edge_of_p == (e.edge_of_p >= 0) &&
                            c.edge_of_q == (e.edge_of_q >= 0));
      }
      EXPECT_TRUE(listed);
    }
  }
  for (const int count : counts) EXPECT_GT(count, 100);
}

/// Up to 2 `vectors` edges in whole numbers, `stretch` times as wide: where that is large, all but a few of them point
/// almost along x.
ConvexPolygon many_edges(int vectors, std::int64_t stretch, scenes::Random& random) {
  std::set<std::pair<std::int64_t, std::int64_t>> edges;
  while (static_cast<int>(edges.size()) < vectors) {
    const std::int64_t x = random.integer(-25, 25), y = random.integer(-25, 25);
    const std::int64_t divisor = std::gcd(x, y);
    if (divisor == 0) continue;
    const std::int64_t sign = y > 0 || (y == 0 && x > 0) ? 1 : -1;
    edges.insert({sign * x / divisor, sign * y / divisor});
  }
  std::vector<std::pair<std::int64_t, std::int64_t>> sorted(edges.begin(), edges.end());
  std::sort(sorted.begin(), sorted.end(),
            [](const auto& a, const auto& b) { return a.first * b.second > a.second * b.first; });
  std::vector<Point2> points;
  std::int64_t x = 0, y = 0;
  for (const std::int64_t sign : {1, -1}) {
    for (const auto& e : sorted) {
      points.push_back({double(stretch * x), double(y)});
      x += sign * e.first;
      y += sign * e.second;
    }
  }
  return polygon(points);
}

TEST(ConvexDepth, PolygonsOfManyVerticesBySlopeOrder) {
  scenes::Random random(test::wanted_seed(66));
  int met = 0, deep = 0;
  for (int round = 0; round < 60; ++round) {
    const int sizes[] = {3, 40, 90, 300, 700};
    const ConvexPolygon p = many_edges(sizes[round % 5], round % 3 == 0 ? 4096 : 1, random);
    const ConvexPolygon q = many_edges(sizes[round / 5 % 5], round % 7 == 0 ? 512 : 1, random);
    const Oracle oracle(p, q);
    std::int64_t low[2] = {oracle.lines[0].x, oracle.lines[0].y}, high[2] = {low[0], low[1]};
    for (const auto& l : oracle.lines) {
      for (const auto& [k, value] : {std::pair{0, l.x}, std::pair{1, l.y}}) {
        low[k] = std::min(low[k], value);
        high[k] = std::max(high[k], value);
      }
    }
    for (int i = 0; i < planar_cases(60); ++i) {
      std::int64_t s = random.integer(int(low[0]), int(high[0])), t = random.integer(int(low[1]), int(high[1]));
      if (i % 6 == 0) {  // a corner of R, where the line runs through two vertices
        const auto& l = oracle.lines[static_cast<std::size_t>(random.integer(0, int(oracle.lines.size()) - 1))];
        s = l.x;
        t = l.y;
      }
      const int dx = random.integer(-30, 30), dy = random.integer(-30, 30);
      if (dx == 0 && dy == 0) continue;
      const Point2 y{double(s), double(t)}, d{double(dx), double(dy)};
      const auto found = convex_directional_depth(p, q, y, d);
      ASSERT_EQ(found->contact, oracle.contact(s, t)) << round << " " << i;
      ASSERT_EQ(*convex_intersection(p, q, y), found->contact) << round << " " << i;
      ++met;
      if (found->contact != PlanarContact::overlapping) continue;
      ++deep;
      oracle.check_direction(s, t, dx, dy, *found);
      const auto crossing = convex_crossing(p, q, y, d);
      ASSERT_TRUE(crossing->meets);
      ASSERT_EQ(crossing->leave_lower, found->lower);
      ASSERT_EQ(crossing->leave_upper, found->upper);
      ASSERT_LT(crossing->enter_upper, 0);
      const Point2 e{double(oracle.lines[0].x), double(oracle.lines[0].y)};
      ASSERT_NE(*convex_intersection(p, q, e), PlanarContact::overlapping);
    }
  }
  EXPECT_GT(deep, met / 3);
}

TEST(ConvexDepth, DepthIsDisplacementLessSeparation) {
  // [D] section 1: moved far enough along d to be apart, Q comes back by the separation; the rest is the depth.
  scenes::Random random(63);
  int checked = 0;
  for (int round = 0; round < 1000; ++round) {
    const auto p = ConvexPolygon::from_points(grid_points(7, 20, random));
    const auto q = ConvexPolygon::from_points(grid_points(6, 10, random));
    if (!p || !q) continue;
    const Point2 y{double(random.integer(-8, 8)), double(random.integer(-8, 8))};
    const Point2 d{double(random.integer(-1, 1)), double(random.integer(-1, 1))};
    if ((d[0] == 0) == (d[1] == 0)) continue;  // along an axis, where |d| = 1
    const PlanarDepth depth = *convex_directional_depth(*p, *q, y, d);
    if (depth.contact != PlanarContact::overlapping) continue;
    const double far = 1024;
    const PlanarCrossing back = *convex_crossing(*p, *q, {y[0] + far * d[0], y[1] + far * d[1]}, {-d[0], -d[1]});
    ASSERT_TRUE(back.meets);
    EXPECT_NEAR(far - back.enter_lower, depth.depth, 1e-12);
    const PlanarCrossing through = *convex_crossing(*p, *q, y, d);
    EXPECT_EQ(through.leave_lower, depth.lower);
    EXPECT_EQ(through.leave_upper, depth.upper);
    EXPECT_LT(through.enter_upper, 0);
    ++checked;
  }
  EXPECT_GT(checked, 200);
}

TEST(ConvexDepth, ProbesAreLogarithmic) {
  scenes::Random random(64);
  for (const int n : {8, 256, 8192}) {
    for (const int m : {8, 8192}) {
      const ConvexPolygon p = polygon(circle(n, 0.3)), q = polygon(circle(m, 0.1, 0.5));
      std::int64_t most = 0, sum = 0;
      for (int i = 0; i < 100; ++i) {
        const scenes::Turn t = scenes::turn(random.uniform());
        const std::int64_t probes = convex_directional_depth(p, q, {0.1, 0.2}, {t.cosine, t.sine})->probes;
        most = std::max(most, probes);
        sum += probes;
      }
      EXPECT_LE(static_cast<double>(most), 40 + 8 * (std::log2(n) + std::log2(m))) << n << " " << m;
      // Two tables: one search, begun between a few directions of theirs, and the class by chords (47 and more by the
      // vertices farthest to the sides and a search behind).
      EXPECT_LE(sum, n > 8 && m > 8 ? 32 * 100 : 100 * 100) << n << " " << m;
    }
  }
}

TEST(MedialAxis, EqualsTheScanOfAllEdges) {
  scenes::Random random(65);
  for (const int n : {3, 4, 5, 12, 100, 2000}) {
    for (const double squash : {1.0, 0.01}) {
      for (const int m : {3, 4, 64}) {
        const ConvexPolygon p = polygon(circle(n, 0.37, squash)), q = polygon(circle(m, 0.2, 0.125));
        const MedialAxis axis = MedialAxis::build(p, q);
        // Every node is as far from its edges as it says, and in the middle of nothing nearer.
        EXPECT_EQ(static_cast<int>(axis.nodes().size()), axis.num_edges() - 2);
        EXPECT_LT(axis.work(), 20 * axis.num_edges() + 50);
        std::vector<Point2> places;
        for (int i = 0; i < 200; ++i) places.push_back({random.uniform(-1.2, 1.2), random.uniform(-1.2, 1.2) * squash});
        for (std::size_t i = 0; i < axis.nodes().size() && i < 50; ++i) {
          const auto& node = axis.nodes()[i * axis.nodes().size() / std::min<std::size_t>(50, axis.nodes().size())];
          EXPECT_NEAR(convex_depth(p, q, node.position)->depth, node.radius, 1e-12);
          places.push_back(node.position);
        }
        places.push_back({0, 0});
        for (const Point2& y : places) {
          const PlanarDepth expected = *convex_depth(p, q, y), found = *axis.depth(y);
          ASSERT_EQ(found.contact, expected.contact);
          ASSERT_EQ(found.lower, expected.lower) << n << " " << m << " " << squash;
          ASSERT_EQ(found.upper, expected.upper);
        }
      }
    }
  }
}

TEST(MedialAxis, WorkIsLinearAndProbesLogarithmic) {
  scenes::Random random(66);
  for (const int n : {1000, 8000, 64000}) {
    const ConvexPolygon p = polygon(circle(n, 0.37, 0.6)), q = polygon(circle(16, 0.2, 0.125));
    const MedialAxis axis = MedialAxis::build(p, q);
    EXPECT_LT(static_cast<double>(axis.work()), 8.0 * n);
    std::int64_t probes = 0;
    for (int i = 0; i < 100; ++i) {
      probes += axis.depth({random.uniform(-0.5, 0.5), random.uniform(-0.3, 0.3)})->probes;
    }
    EXPECT_LT(static_cast<double>(probes) / 100, 60 + 15 * std::log2(n)) << n;
  }
}

}  // namespace
}  // namespace pd
