// What is a polygon, and what is refused, with the edge at fault.
#include "pd/planar/polygon.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace {

using pd::ErrorCode;
using pd::Point2;
using pd::Polygon;
using Ring = std::vector<Point2>;

const Ring kSquare = {{0, 0}, {10, 0}, {10, 10}, {0, 10}};

void expect_refused(const Ring& outer, const std::vector<Ring>& holes, ErrorCode code, const std::string& where) {
  const auto made = Polygon::from_rings(outer, holes);
  ASSERT_FALSE(made.has_value());
  EXPECT_EQ(made.error().code, code) << made.error().message;
  EXPECT_EQ(made.error().where, where) << made.error().message;
  EXPECT_FALSE(made.error().message.empty());
}

TEST(Polygon, EitherOrientationIsTheSamePolygon) {
  const Ring hole = {{2, 2}, {4, 2}, {4, 4}};
  const auto a = *Polygon::from_rings(kSquare, std::vector<Ring>{hole});
  const auto b =
      *Polygon::from_rings(Ring(kSquare.rbegin(), kSquare.rend()), std::vector<Ring>{Ring(hole.rbegin(), hole.rend())});
  ASSERT_EQ(a.num_vertices(), 7);
  EXPECT_TRUE(std::equal(a.points().begin(), a.points().end(), b.points().begin(), b.points().end()));
  EXPECT_EQ(a.caller_id(1), (Polygon::VertexId{-1, 1}));
  EXPECT_EQ(b.caller_id(1), (Polygon::VertexId{-1, 2}));
  EXPECT_FALSE(a.convex());
  EXPECT_TRUE(Polygon::from_rings(kSquare)->convex());
}

TEST(Polygon, DuplicatesAndCollinearVerticesMelt) {
  const Ring ring = {{0, 0}, {5, 0}, {5, 0}, {10, 0}, {10, 0}, {10, 10}, {0, 10}, {0, 5}, {0, 0}};
  const auto p = *Polygon::from_rings(ring);
  EXPECT_EQ(p.num_vertices(), 4);
  EXPECT_EQ(p.caller_id(1).index, 3);
}

TEST(Polygon, NamedRefusals) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  expect_refused({{0, 0}, {1, nan}, {1, 1}}, {}, ErrorCode::non_finite, "outer[1]");
  expect_refused({{0, 0}, {1e301, 0}, {1, 1}}, {}, ErrorCode::out_of_range, "outer[1]");
  expect_refused({{0, 0}, {1, 0}, {0, 0}}, {}, ErrorCode::too_few_points, "outer");
  expect_refused({{0, 0}, {1, 1}, {2, 2}, {5, 5}}, {}, ErrorCode::not_full_dimensional, "outer");
  expect_refused({{0, 0}, {4, 4}, {4, 0}, {0, 4}}, {}, ErrorCode::bad_value, "outer[0]");          // crosses
  expect_refused({{0, 0}, {4, 0}, {6, 0}, {4, 0}, {4, 4}}, {}, ErrorCode::bad_value, "outer[2]");  // folds back
  expect_refused({{0, 0}, {4, 0}, {2, 2}, {4, 4}, {0, 4}, {2, 2}}, {}, ErrorCode::bad_value,
                 "outer[2]");                                                                   // touches itself
  expect_refused(kSquare, {{{11, 1}, {12, 1}, {12, 2}}}, ErrorCode::bad_value, "holes[0][0]");  // outside
  expect_refused(kSquare, {{{-3, 1}, {-2, 1}, {-2, 2}}}, ErrorCode::bad_value, "holes[0][0]");
  expect_refused(kSquare, {{{8, 1}, {12, 1}, {12, 2}}}, ErrorCode::bad_value, "outer[1]");  // crosses the outer ring
  expect_refused(kSquare, {{{1, 1}, {5, 1}, {5, 5}}, {{4, 2}, {8, 2}, {8, 4}}}, ErrorCode::bad_value, "holes[1][0]");
  expect_refused(kSquare, {{{1, 1}, {9, 1}, {9, 9}, {1, 9}}, {{2, 2}, {3, 2}, {3, 3}}}, ErrorCode::bad_value,
                 "holes[1][0]");
  expect_refused(kSquare, {{{1, 1}, {nan, 1}, {9, 9}}}, ErrorCode::non_finite, "holes[0][1]");
}

TEST(Polygon, TouchingByTheLastBit) {
  // The apex of the hole is on, just under and just over the upper edge from (0, 0) to (3, 1).
  const auto with_apex = [](double y) {
    return Polygon::from_rings(Ring{{0, 0}, {3, 1}, {3, 3}, {0, 3}}, std::vector<Ring>{{{1.5, y}, {2, 2}, {1, 2}}})
        .has_value();
  };
  EXPECT_TRUE(with_apex(0.5));
  EXPECT_TRUE(with_apex(std::nextafter(0.5, 1.0)));
  EXPECT_FALSE(with_apex(std::nextafter(0.5, 0.0)));
}

TEST(Polygon, EdgesAreNamedInTheCallersOrder) {
  const std::vector<Point2> points = {{0, 0}, {4, 0}, {4, 2}, {4, 4}, {0, 4}};  // [2] lies on an edge
  const std::vector<Point2> turned(points.rbegin(), points.rend());
  for (const auto& ring : {points, turned}) {
    const Polygon polygon = *Polygon::from_rings(ring);
    for (int v = 0; v < polygon.num_vertices(); ++v) {
      const Point2 &a = polygon.point(v), &b = polygon.point(polygon.next(v));
      const auto named = static_cast<std::size_t>(polygon.caller_edge(v).index);
      const Point2& following = ring[(named + 1) % ring.size()];
      EXPECT_TRUE(ring[named] == a || ring[named] == b);
      // What follows it in the caller's ring lies on the same edge.
      EXPECT_EQ((b[0] - a[0]) * (following[1] - a[1]) - (b[1] - a[1]) * (following[0] - a[0]), 0);
    }
  }
}

}  // namespace
