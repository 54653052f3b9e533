/// @file
/// [D] Lemma 5.2 by outer hierarchies: lines against every level, beside the inner hierarchy's descent and a scan of
/// all facets in exact arithmetic; lines along edges, through vertices and in facets.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>
#include <tuple>

#include "numeric/dyadic.hpp"
#include "oracle/wanted_cases.hpp"
#include "pd/depth/level_queries.hpp"
#include "scenes/shape_families.hpp"

namespace pd {
namespace {

using detail::Dyadic;
using detail::Dyadic3;
using detail::to_dyadic;

ConvexPolytope hull(const scenes::Points& points) { return *ConvexPolytope::from_points(points); }

struct Interval {
  Dyadic enter, enter_by, leave, leave_by;  ///< quotients, denominators positive
};

/// By all facets, in exact arithmetic: the times at which the line is in the interior.
std::optional<Interval> scan(const ConvexPolytope& body, const Vec3& point, const Vec3& direction) {
  std::optional<std::pair<Dyadic, Dyadic>> enter, leave;
  for (int f = 0; f < body.num_facets(); ++f) {
    const auto loop = body.facet_vertices(f);
    const Dyadic3 c = to_dyadic(body.vertex(loop[0]));
    const Dyadic3 n = cross(to_dyadic(body.vertex(loop[1])) - c, to_dyadic(body.vertex(loop[2])) - c);
    Dyadic slope = dot(n, to_dyadic(direction)), offset = dot(n, c - to_dyadic(point));
    if (slope.sign() == 0 && offset.sign() <= 0) return std::nullopt;
    if (slope.sign() == 0) continue;
    auto& bound = slope.sign() < 0 ? enter : leave;
    const bool entering = slope.sign() < 0;
    if (entering) {
      slope = -slope;
      offset = -offset;
    }
    if (bound) {
      const int sign = (offset * bound->second - bound->first * slope).sign();
      if (entering ? sign <= 0 : sign >= 0) continue;
    }
    bound = {offset, slope};
  }
  if ((enter->first * leave->second - leave->first * enter->second).sign() >= 0) return std::nullopt;
  return Interval{enter->first, enter->second, leave->first, leave->second};
}

/// Whether lower <= (numerator / denominator) |d| <= upper, exactly, and the bracket is of two neighbours.
void expect_bracket(double lower, double upper, const Dyadic& numerator, const Dyadic& denominator, const Vec3& d) {
  const Dyadic3 e = to_dyadic(d);
  const Dyadic square = numerator * numerator * dot(e, e);
  const auto compare = [&](double x) {  // sign of value - x
    const int sign = numerator.sign();
    const Dyadic dx = Dyadic(x) * denominator;
    if (sign != dx.sign()) return sign > dx.sign() ? 1 : -1;
    return sign * (square - dx * dx).sign();
  };
  EXPECT_GE(compare(lower), 0);
  EXPECT_LE(compare(upper), 0);
  EXPECT_LE(upper, std::nextafter(lower, std::numeric_limits<double>::infinity()));
}

struct Tally {
  int hits = 0, misses = 0;
  std::int64_t repairs = 0;
};

void judge(const TwinHierarchy& twin, int level, const Vec3& point, const Vec3& d, Tally& tally) {
  const LevelCrossing found = *crossing_of_level(twin, level, point, d);
  const auto expected = scan(twin.outer(level).polytope(), point, d);
  tally.repairs += found.repairs;
  ASSERT_EQ(found.meets, expected.has_value()) << level << ": " << point.transpose() << ", " << d.transpose();
  if (!expected) {
    ++tally.misses;
    return;
  }
  ++tally.hits;
  expect_bracket(found.enter_lower, found.enter_upper, expected->enter, expected->enter_by, d);
  expect_bracket(found.leave_lower, found.leave_upper, expected->leave, expected->leave_by, d);
}

std::vector<ConvexPolytope> bodies(int n, scenes::Random& random) {
  return {hull(scenes::sphere_hull(n, random)),
          hull(scenes::needle(n, random)),
          hull(scenes::prism(n)),
          hull(scenes::roof(std::max(n, 10), {}, random)),
          hull(scenes::box(Vec3(1, 2, 3))),
          hull(scenes::integer_points(n, 4, random))};
}

TEST(OuterCrossing, LinesThroughEveryLevelAgainstAScan) {
  const int lines = test::wanted_cases("PD_LEVEL_LINES", 30);
  scenes::Random random(test::wanted_seed(71));
  Tally tally;
  for (const int n : {6, 40, 250}) {
    for (const ConvexPolytope& body : bodies(n, random)) {
      const TwinHierarchy twin = *TwinHierarchy::build(body);
      for (int level = 0; level < twin.num_levels(); ++level) {
        for (int i = 0; i < lines; ++i) {
          // Points near the body and far from it, most of whose lines miss.
          const double reach = (i % 3 == 0 ? 3.0 : 0.8) * body.radius();
          const Vec3 point = random.vector(0, reach);
          judge(twin, level, point, random.vector(0.1, 4), tally);
        }
      }
    }
  }
  RecordProperty("lines", tally.hits + tally.misses);
  EXPECT_GT(tally.hits, 20 * lines);
  EXPECT_GT(tally.misses, 20 * lines);
  // What rounding hides from the descent is the exception.
  EXPECT_LT(tally.repairs, (tally.hits + tally.misses) / 1000 + 1);
}

TEST(OuterCrossing, LinesAlongEdgesAndThroughVertices) {
  scenes::Random random(72);
  Tally tally;
  for (const ConvexPolytope& body : bodies(30, random)) {
    const TwinHierarchy twin = *TwinHierarchy::build(body);
    for (int level = 0; level < twin.num_levels(); ++level) {
      const ConvexPolytope& p = twin.outer(level).polytope();
      const auto vertex = [&] { return p.vertex(random.integer(0, p.num_vertices() - 1)); };
      for (int i = 0; i < 40; ++i) {
        const Vec3 v = vertex(), w = vertex();
        const Vec3 edge = p.vertex(p.target(random.integer(0, p.num_half_edges() - 1)));
        judge(twin, level, v, random.direction(), tally);
        if (v != w) judge(twin, level, v, w - v, tally);
        if (v != edge) judge(twin, level, v, edge - v, tally);
        const int h = random.integer(0, p.num_half_edges() - 1);
        const Vec3 from = p.vertex(p.half_edge(h).origin), along = p.vertex(p.target(h)) - from;
        judge(twin, level, from, along, tally);
        judge(twin, level, from + 0.5 * along, random.direction(), tally);
      }
    }
  }
  EXPECT_GT(tally.hits, 1000);
  EXPECT_GT(tally.misses, 1000);
}

TEST(OuterCrossing, TheInnerDescentSaysTheSame) {
  scenes::Random random(73);
  int hits = 0;
  for (const ConvexPolytope& body : bodies(200, random)) {
    const TwinHierarchy twin = *TwinHierarchy::build(body);
    for (int level = 0; level < twin.num_levels(); ++level) {
      for (int i = 0; i < 20; ++i) {
        const Vec3 point = random.vector(0, 0.7 * body.radius()), d = random.direction();
        const LevelCrossing outer = *crossing_of_level(twin, level, point, d);
        const LevelCrossing inner = *crossing_of_level(twin.inner(), level, hull({point}), d);
        // The inner descent says when the moved point meets the level: the same times.
        ASSERT_EQ(outer.meets, inner.meets) << level;
        if (!outer.meets) continue;
        ++hits;
        EXPECT_NEAR(outer.enter_lower, inner.enter_lower, 1e-12 * body.radius());
        EXPECT_NEAR(outer.leave_upper, inner.leave_upper, 1e-12 * body.radius());
        if (level > 0) continue;
        EXPECT_EQ(std::tie(outer.enter_lower, outer.enter_upper), std::tie(inner.enter_lower, inner.enter_upper));
        EXPECT_EQ(std::tie(outer.leave_lower, outer.leave_upper), std::tie(inner.leave_lower, inner.leave_upper));
      }
    }
  }
  EXPECT_GT(hits, 300);
}

TEST(OuterCrossing, StepsAreLogarithmic) {
  scenes::Random random(74);
  for (const int n : {100, 400, 1600, -800}) {
    // A prism's caps have as many neighbours as corners: only the final check looks at them.
    const ConvexPolytope body = hull(n > 0 ? scenes::sphere_hull(n, random) : scenes::prism(-n));
    const TwinHierarchy twin = *TwinHierarchy::build(body);
    std::int64_t most = 0;
    for (int i = 0; i < 200; ++i) {
      const Vec3 point = random.vector(0, 1);
      most = std::max(most, crossing_of_level(twin, 0, point, random.direction())->steps);
    }
    EXPECT_LT(static_cast<double>(most), 40 * std::log2(std::abs(n))) << n;
  }
}

TEST(OuterCrossing, RefusesByName) {
  const TwinHierarchy twin = *TwinHierarchy::build(hull(scenes::box(Vec3(1, 1, 1))));
  const auto code = [](const Expected<LevelCrossing>& e) { return e ? ErrorCode::unsupported : e.error().code; };
  EXPECT_EQ(code(crossing_of_level(twin, 99, Vec3::Zero(), Vec3::UnitX())), ErrorCode::out_of_range);
  EXPECT_EQ(code(crossing_of_level(twin, -1, Vec3::Zero(), Vec3::UnitX())), ErrorCode::out_of_range);
  EXPECT_EQ(code(crossing_of_level(twin, 0, Vec3::Zero(), Vec3::Zero())), ErrorCode::zero_direction);
  EXPECT_EQ(code(crossing_of_level(twin, 0, Vec3::Zero(), Vec3(0, NAN, 0))), ErrorCode::non_finite);
  EXPECT_EQ(code(crossing_of_level(twin, 0, Vec3(0, 0, INFINITY), Vec3::UnitX())), ErrorCode::non_finite);
  const LevelCrossing through = *crossing_of_level(twin, 0, Vec3(0, 0, 5), Vec3(0, 0, 2));
  EXPECT_EQ(through.enter_lower, -6);
  EXPECT_EQ(through.leave_upper, -4);
}

}  // namespace
}  // namespace pd
