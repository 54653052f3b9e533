// Directional depth for fixed sets of directions, against an oracle that tries everything and against rays.
#include "pd/planar/direction_set.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "planar/polygon_oracle.hpp"
#include "planar/small_polygons.hpp"
#include "scenes/polygon_families.hpp"

namespace {

using pd::DirectionSet;
using pd::PlanarContact;
using pd::Point2;
using pd::PolygonDepth;
using pd::PolygonDifference;
using pd::PolygonMethod;
using pd::test::made;
using pd::test::planar_cases;
using pd::test::SmallPolygons;
using pd::test::text;

const std::vector<Point2> kDirections = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}, {1, 1}, {-2, 1}, {1, -3}, {-1, -1}};

bool same(const PolygonDepth& a, const PolygonDepth& b) {
  return a.contact == b.contact && a.lower == b.lower && a.upper == b.upper && a.translation == b.translation;
}

/// Every direction, some placements: the bits of rays. @return the number of answers compared.
int compare(const oracle::Rings& p, const oracle::Rings& q, PolygonMethod method, SmallPolygons& next, int placements) {
  const auto r = PolygonDifference::of(made(p), made(q), method).value();
  const auto set = DirectionSet::of(r, kDirections).value();
  int answers = 0;
  for (int i = 0; i < placements; ++i) {
    const Point2 y = {next.eighths(-2, 6), next.eighths(-2, 6)};
    for (int k = 0; k < set.num_directions(); ++k) {
      const PolygonDepth found = set.depth(y, k), expected = r.depth_along(y, kDirections[static_cast<std::size_t>(k)]);
      EXPECT_TRUE(same(found, expected)) << "p " << text(p) << " q " << text(q) << " y " << y[0] << "," << y[1]
                                         << " direction " << k << ": " << found.depth << " " << to_string(found.contact)
                                         << ", rays say " << expected.depth << " " << to_string(expected.contact);
      EXPECT_EQ(found.feature.has_value(), expected.contact != PlanarContact::separated);
      ++answers;
    }
  }
  return answers;
}

TEST(DirectionSet, AgainstTheOracle) {
  SmallPolygons next(44);
  for (int i = 0; i < planar_cases(150) && !HasFailure(); ++i) {
    const oracle::Rings p = next.simple(7, next.whole(3, 7), i % 3 == 0), q = next.convex(5, next.whole(1, 5));
    const auto r = PolygonDifference::of(made(p), made(q)).value();
    const auto set = DirectionSet::of(r, kDirections).value();
    const oracle::PolygonOracle truth(p, q);
    for (int k = 0; k < set.num_directions(); ++k) {
      const Point2 y = {next.eighths(-2, 6), next.eighths(-2, 6)};
      const PolygonDepth found = set.depth(y, k);
      const std::string what = "p " + text(p) + " q " + text(q) + " y " + std::to_string(y[0]) + "," +
                               std::to_string(y[1]) + " direction " + std::to_string(k);
      EXPECT_EQ(to_string(found.contact), truth.contact(y)) << what;
      if (found.contact != PlanarContact::overlapping) {
        EXPECT_EQ(found.depth, 0) << what;
        continue;
      }
      EXPECT_NEAR(found.depth, truth.depth_along(y, set.direction(k)), 1e-8) << what;
    }
  }
}

TEST(DirectionSet, GivesTheBitsOfRays) {
  SmallPolygons next(9);
  int answers = 0;
  for (int i = 0; i < planar_cases(300) && !HasFailure(); ++i) {
    const int grid = next.whole(3, 12);
    answers += compare(next.simple(9, grid, i % 2 == 0), next.convex(7, next.whole(1, grid)), PolygonMethod::implicit,
                       next, 12);
    answers += compare(next.convex(6, grid), next.simple(7, grid, i % 2 == 0), PolygonMethod::automatic, next, 6);
    answers += compare(next.simple(6, grid, i % 3 == 0), next.simple(5, next.whole(1, 4), false),
                       PolygonMethod::explicit_sums, next, 4);
  }
  EXPECT_GE(answers, planar_cases(300) * 22 * 8);
}

// Placements on the boundary itself and on lines through its corners: every curve's ends are tried.
TEST(DirectionSet, PlacementsAtCornersOfTheBoundary) {
  SmallPolygons next(12);
  int touching = 0;
  for (int i = 0; i < planar_cases(100); ++i) {
    const oracle::Rings p = next.simple(8, 6, i % 2 == 0), q = next.convex(6, 4);
    const auto r = PolygonDifference::of(made(p), made(q)).value();
    const auto set = DirectionSet::of(r, kDirections).value();
    for (const auto& curve : r.boundary_curves()) {
      for (const Point2& corner : curve.points) {
        for (const Point2& y : {corner, Point2{corner[0], corner[1] + 0.5}, Point2{corner[0] - 0.25, corner[1]}}) {
          for (int k = 0; k < set.num_directions(); ++k) {
            const PolygonDepth found = set.depth(y, k);
            ASSERT_TRUE(same(found, r.depth_along(y, set.direction(k))))
                << "p " << text(p) << " q " << text(q) << " y " << y[0] << "," << y[1] << " direction " << k;
            touching += found.contact == PlanarContact::touching ? 1 : 0;
          }
        }
      }
    }
  }
  EXPECT_GT(touching, 100);
}

TEST(DirectionSet, RoundPolygonsAndStars) {
  pd::scenes::Random random(8);
  std::vector<Point2> directions = {{1, 0}, {0, 1}};
  for (int k = 0; k < 6; ++k) {
    const pd::scenes::Turn t = pd::scenes::turn(random.uniform());
    directions.push_back({t.cosine, t.sine});
  }
  for (const double radius : {0.01, 0.2, 0.9}) {
    const auto r =
        PolygonDifference::of(pd::scenes::star_polygon(60, random), pd::scenes::round_polygon(64, radius)).value();
    const auto set = DirectionSet::of(r, directions).value();
    int overlapping = 0;
    for (int i = 0; i < 400; ++i) {
      const Point2 y = {random.uniform(-1.6, 1.6), random.uniform(-1.6, 1.6)};
      for (int k = 0; k < set.num_directions(); ++k) {
        const PolygonDepth found = set.depth(y, k);
        ASSERT_TRUE(same(found, r.depth_along(y, set.direction(k)))) << y[0] << "," << y[1] << " direction " << k;
        overlapping += found.contact == PlanarContact::overlapping ? 1 : 0;
      }
    }
    EXPECT_GT(overlapping, 400);
  }
}

// [D] section 6: O(log n) signs a query.
TEST(DirectionSet, SignsGrowWithTheLogarithm) {
  pd::scenes::Random random(2);
  const std::vector<Point2> directions = {{0.3, 1}};
  for (const int n : {40, 200, 1000}) {
    const auto r =
        PolygonDifference::of(pd::scenes::star_polygon(n, random), pd::scenes::round_polygon(16, 0.3 / n)).value();
    const auto set = DirectionSet::of(r, directions).value();
    const double log = std::log2(static_cast<double>(set.statistics().pieces)) + 4;
    std::int64_t most = 0;
    for (int i = 0; i < 500; ++i) {
      std::int64_t probes = 0;
      (void)set.depth({random.uniform(-1, 1), random.uniform(-1, 1)}, 0, &probes);
      most = std::max(most, probes);
    }
    EXPECT_LE(static_cast<double>(most), 2.5 * log + 6);
  }
}

TEST(DirectionSet, NamedRefusals) {
  const auto r = PolygonDifference::of(made({{{0, 0}, {1, 0}, {0, 1}}}), made({{{0, 0}, {1, 0}, {0, 1}}})).value();
  const auto refused = [&](const Point2& d, pd::ErrorCode code) {
    const auto set = DirectionSet::of(r, std::vector<Point2>{{1, 0}, d});
    ASSERT_FALSE(set.has_value());
    EXPECT_EQ(set.error().code, code);
    EXPECT_EQ(set.error().where, "directions[1]");
  };
  refused({0, 0}, pd::ErrorCode::zero_direction);
  refused({0, std::numeric_limits<double>::infinity()}, pd::ErrorCode::non_finite);
  refused({0, 1e301}, pd::ErrorCode::out_of_range);
  EXPECT_EQ(DirectionSet::of(r, {})->num_directions(), 0);
}

}  // namespace
