/// @file
/// A line moved onto P, against the exact shadow of all differences of vertices (whole numbers, every pair of them
/// across the ray's line) and, turned at random, against the lines before and after the contact.
#include "pd/depth/translating_line.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "pd/depth/difference_queries.hpp"
#include "scenes/shape_families.hpp"

namespace pd {
namespace {

using Whole = std::int64_t;
struct Whole3 {
  Whole x, y, z;
};
Whole dot(const Whole3& u, const Whole3& v) { return u.x * v.x + u.y * v.y + u.z * v.z; }
Whole3 cross(const Whole3& u, const Whole3& v) {
  return {u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
}
Vec3 real(const Whole3& v) { return {double(v.x), double(v.y), double(v.z)}; }

/// t in units of |v|, from every pair of points on different sides of the ray's line.
struct Interval {
  bool crosses = false;
  long double first = 0, last = 0;
};

Interval brute_force(const std::vector<Whole3>& a, const std::vector<Whole3>& b, const Whole3& p, const Whole3& d,
                     const Whole3& v) {
  const Whole3 across = cross(v, d), forwards = cross(d, across);
  struct Seen {
    Whole side, forward;
  };
  std::vector<Seen> seen;
  for (const Whole3& x : a) {
    for (const Whole3& y : b) {
      const Whole3 q{y.x - x.x - p.x, y.y - x.y - p.y, y.z - x.z - p.z};
      seen.push_back({dot(q, across), dot(q, forwards)});
    }
  }
  Interval interval;
  const auto add = [&](long double t) {
    interval.first = interval.crosses ? std::min(interval.first, t) : t;
    interval.last = interval.crosses ? std::max(interval.last, t) : t;
    interval.crosses = true;
  };
  const auto unit = static_cast<long double>(dot(across, across));
  for (const Seen& l : seen) {
    if (l.side == 0) add(static_cast<long double>(l.forward) / unit);
    if (l.side <= 0) continue;
    for (const Seen& r : seen) {
      if (r.side >= 0) continue;
      add(static_cast<long double>(r.forward * l.side - l.forward * r.side) /
          (unit * static_cast<long double>(l.side - r.side)));
    }
  }
  return interval;
}

std::vector<Vec3> real(const std::vector<Whole3>& points) {
  std::vector<Vec3> out;
  for (const Whole3& p : points) out.push_back(real(p));
  return out;
}

TEST(TranslatingLine, WholeNumbersAgainstEveryPairOfVertices) {
  // Small numbers: lines through vertices, along edges and facets, shadows that are segments or points.
  std::mt19937_64 random(31);
  int met = 0, missed = 0, grazed = 0, at_start = 0;
  for (int round = 0; round < 4000 && !testing::Test::HasFailure(); ++round) {
    SCOPED_TRACE(round);
    const Whole range = round % 2 == 0 ? 2 : 40;
    std::uniform_int_distribution<Whole> coordinate(-range, range);
    const auto vector = [&] { return Whole3{coordinate(random), coordinate(random), coordinate(random)}; };
    std::vector<Whole3> points_a, points_b;
    for (int i = 0; i < 1 + round % 9; ++i) points_a.push_back(vector());
    for (int i = 0; i < 1 + round % 7; ++i) points_b.push_back(vector());
    const ConvexShape a(*ConvexPolytope::from_points(real(points_a)));
    const ConvexShape b(*ConvexPolytope::from_points(real(points_b)));
    Whole3 p = vector(), d = vector(), v = vector();
    p = {3 * p.x, 2 * p.y, 2 * p.z};
    const Whole3 across = cross(v, d);
    if (dot(across, across) == 0) {
      const auto refused = translating_line_in_difference({&a, Pose()}, {&b, Pose()}, real(p), real(d), real(v));
      ASSERT_FALSE(refused.has_value());
      EXPECT_EQ(refused.error().code, ErrorCode::zero_direction);
      continue;
    }
    const Interval expected = brute_force(points_a, points_b, p, d, v);
    const auto line = translating_line_in_difference({&a, Pose()}, {&b, Pose()}, real(p), real(d), real(v));
    ASSERT_TRUE(line.has_value());
    // Exactly zero in long double, too: quotients of whole numbers below 2^63.
    ASSERT_EQ(line->meets, expected.crosses && expected.last >= 0);
    if (!line->meets) {
      ++missed;
      EXPECT_EQ(line->last_upper, 0);
      continue;
    }
    ++met;
    grazed += expected.first == expected.last ? 1 : 0;
    at_start += expected.first <= 0 ? 1 : 0;
    const long double length = std::sqrt(static_cast<long double>(dot(v, v)));
    const long double first = std::max(0.0L, expected.first) * length, last = expected.last * length;
    const long double slack = 1e-18L * last;
    EXPECT_LE(line->first_lower, first + slack);
    EXPECT_GE(line->first_upper, first - slack);
    EXPECT_LE(line->last_lower, last + slack);
    EXPECT_GE(line->last_upper, last - slack);
    EXPECT_LE(line->first_upper, std::nextafter(line->first_lower, HUGE_VAL));
    EXPECT_LE(line->last_upper, std::nextafter(line->last_lower, HUGE_VAL));
  }
  EXPECT_GT(met, 500);
  EXPECT_GT(missed, 500);
  EXPECT_GT(grazed, 50);
  EXPECT_GT(at_start, 50);
}

TEST(TranslatingLine, TheLineCrossesPBetweenItsTimesOnly) {
  scenes::Random random(32);
  int met = 0;
  for (int round = 0; round < 150; ++round) {
    const int n = 4 + round % 60;
    const ConvexShape a(*ConvexPolytope::from_points(scenes::sphere_hull(n, random)));
    const ConvexShape b(*ConvexPolytope::from_points(scenes::sphere_hull(64 - round % 60, random)));
    const PosedShape posed_a{&a, random.pose(3 * random.direction())};
    const PosedShape posed_b{&b, random.pose(Vec3(1, 2, 3))};
    const Vec3 point = 6 * random.direction(), direction = random.direction();
    const Vec3 centre = posed_b.pose.translation() - posed_a.pose.translation();
    const Vec3 motion = 100 * (centre - point + 3 * random.direction());
    const auto line = translating_line_in_difference(posed_a, posed_b, point, direction, motion);
    ASSERT_TRUE(line.has_value());
    const auto crosses = [&](double t) {
      return line_in_difference(posed_a, posed_b, point + t * motion.normalized(), direction)->crosses;
    };
    if (!line->meets) {
      for (double t = 0; t < 10; t += 0.25) EXPECT_FALSE(crosses(t)) << round;
      continue;
    }
    ++met;
    EXPECT_TRUE(crosses(line->first_upper + 1e-9)) << round;
    EXPECT_TRUE(crosses(line->last_lower - 1e-9)) << round;
    EXPECT_FALSE(crosses(line->last_upper + 1e-9)) << round;
    if (line->first_lower > 0) {
      EXPECT_FALSE(crosses(line->first_lower - 1e-9)) << round;
    }
    // Backwards from beyond: the same two places.
    const double far = line->last_upper + 8;
    const auto back =
        translating_line_in_difference(posed_a, posed_b, point + far * motion.normalized(), direction, -motion);
    ASSERT_TRUE(back.has_value() && back->meets);
    EXPECT_NEAR(far - back->first_upper, line->last_upper, 1e-12);
  }
  EXPECT_GT(met, 40);
}

TEST(TranslatingLine, SupportsGrowLikeALogarithm) {
  scenes::Random random(33);
  for (const int n : {64, 4096}) {
    const ConvexShape a(*ConvexPolytope::from_points(scenes::sphere_hull(n, random)));
    std::int64_t most = 0;
    for (int k = 0; k < 50; ++k) {
      const Vec3 point = 3 * random.direction(), direction = random.direction(), motion = random.direction();
      const auto line = translating_line_in_difference({&a, Pose()}, {&a, Pose()}, point, direction, motion);
      ASSERT_TRUE(line.has_value());
      most = std::max(most, line->support_calls);
    }
    EXPECT_LE(most, 4 + 4 * static_cast<std::int64_t>(std::log2(n))) << n;
  }
}

TEST(TranslatingLine, RefusesByName) {
  const ConvexShape cube(*ConvexPolytope::box(Vec3(1, 1, 1))), ball(*ConvexShape::sphere(1));
  const PosedShape box{&cube, Pose()};
  const Vec3 x = Vec3::UnitX(), y = Vec3::UnitY(), zero = Vec3::Zero();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refusal = [](const Expected<TranslatingLine>& answer) {
    return answer ? std::string("none") : std::string(to_string(answer.error().code)) + " " + answer.error().where;
  };
  EXPECT_EQ(refusal(translating_line_in_difference(box, box, Vec3(0, nan, 0), x, y)), "non_finite point");
  EXPECT_EQ(refusal(translating_line_in_difference(box, box, zero, Vec3(nan, 0, 0), y)), "non_finite direction");
  EXPECT_EQ(refusal(translating_line_in_difference(box, box, zero, x, Vec3(0, 0, HUGE_VAL))), "non_finite motion");
  EXPECT_EQ(refusal(translating_line_in_difference(box, box, Vec3(0, 2e300, 0), x, y)), "out_of_range point");
  EXPECT_EQ(refusal(translating_line_in_difference(box, box, zero, zero, y)), "zero_direction direction");
  EXPECT_EQ(refusal(translating_line_in_difference(box, box, zero, x, zero)), "zero_direction motion");
  EXPECT_EQ(refusal(translating_line_in_difference(box, box, zero, x, -3 * x)), "zero_direction motion");
  EXPECT_EQ(refusal(translating_line_in_difference(box, {&ball, Pose()}, zero, x, y)), "unsupported ");
  // P = [-2, 2]^3.
  const auto line = translating_line_in_difference(box, box, Vec3(-10, 0, 2), y, 1e-300 * x);
  ASSERT_TRUE(line.has_value());
  EXPECT_TRUE(line->meets);
  EXPECT_EQ(line->first_lower, 8);
  EXPECT_EQ(line->first_upper, 8);
  EXPECT_EQ(line->last_upper, 12);
  EXPECT_FALSE(translating_line_in_difference(box, box, Vec3(-10, 0, std::nextafter(2.0, 3.0)), y, x)->meets);
  EXPECT_FALSE(translating_line_in_difference(box, box, Vec3(3, 0, 0), y, x)->meets);
}

}  // namespace
}  // namespace pd
