/// @file
/// Grids of directions: the certified covering radius against random directions, sizes, and refusals.
#include "pd/structure/direction_grid.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "scenes/shape_families.hpp"

namespace pd {
namespace {

double nearest_cosine(const DirectionGrid& grid, const Vec3& x, GridExtent extent) {
  double best = -1;
  for (const Vec3& d : grid.directions) {
    const double cosine = d.dot(x);
    best = std::max(best, extent == GridExtent::sphere ? cosine : std::abs(cosine));
  }
  return best;
}

TEST(DirectionGrid, CoversTheSphere) {
  scenes::Random random(11);
  for (const GridKind kind : {GridKind::geodesic, GridKind::latitude_longitude}) {
    for (const GridExtent extent : {GridExtent::sphere, GridExtent::hemisphere}) {
      for (const double delta : {1.0, 0.5, 0.2, 0.1, 0.03, 0.01, 0.001}) {
        const DirectionGrid grid = *direction_grid(kind, delta, extent);
        EXPECT_GE(grid.cosine * (1 + delta), 1);
        for (const Vec3& d : grid.directions) ASSERT_NEAR(d.norm(), 1, 1e-15);
        for (int i = 0; i < 1000; ++i) {
          ASSERT_GE(nearest_cosine(grid, random.direction(), extent), grid.cosine) << delta;
        }
        // Where coverings are worst: the poles, the equator, and the antipodes of the seam.
        for (const Vec3& x : {Vec3(0, 0, 1), Vec3(0, 0, -1), Vec3(-1, 0, 0), Vec3(1, 0, 0), Vec3(-1, 1e-9, 0)}) {
          ASSERT_GE(nearest_cosine(grid, x.normalized(), extent), grid.cosine) << delta;
        }
      }
    }
  }
}

/// The middle of the hole among the three directions that lie nearest to `x`: as far from all three, and its cosine.
long double cosine_in_hole(const DirectionGrid& grid, const Vec3& x, Vec3& middle) {
  std::vector<Vec3> near(3);
  std::partial_sort_copy(grid.directions.begin(), grid.directions.end(), near.begin(), near.end(),
                         [&](const Vec3& d, const Vec3& e) { return d.dot(x) > e.dot(x); });
  using Exactly = Eigen::Matrix<long double, 3, 1>;
  const Exactly p = near[0].cast<long double>(), q = near[1].cast<long double>(), r = near[2].cast<long double>();
  const Exactly across = (q - p).cross(r - p).normalized();
  middle = (across.dot(p) > 0 ? across : Exactly(-across)).cast<double>();
  return std::abs(across.dot(p));
}

/// Holes of a geodesic grid are alike but for rounding: the stated cosine lies below the last bits of each.
TEST(DirectionGrid, CosineHoldsInTheMiddleOfEveryHole) {
  scenes::Random random(12);
  int holes = 0;
  for (const double delta : {1.0, 0.5, 0.3, 0.2, 0.15, 0.1, 0.07, 0.05, 0.04, 0.03}) {
    const DirectionGrid grid = *direction_grid(GridKind::geodesic, delta);
    for (int i = 0; i < 400; ++i) {
      Vec3 middle;
      const long double cosine = cosine_in_hole(grid, random.direction(), middle);
      if (nearest_cosine(grid, middle, GridExtent::sphere) > static_cast<double>(cosine) + 1e-9) continue;
      ++holes;
      ASSERT_GE(cosine, static_cast<long double>(grid.cosine)) << delta;
    }
  }
  EXPECT_GT(holes, 3000);
}

TEST(DirectionGrid, SizesAreProportionalToOneOverDelta) {
  for (const double delta : {1e-3, 1e-4, 1e-5}) {
    const auto size = [&](GridKind kind, GridExtent extent) {
      return static_cast<double>(direction_grid(kind, delta, extent)->directions.size()) * delta;
    };
    EXPECT_LT(size(GridKind::geodesic, GridExtent::sphere), 2.95);
    EXPECT_GT(size(GridKind::geodesic, GridExtent::sphere), 2.42);  // the bound of all coverings
    EXPECT_LT(size(GridKind::geodesic, GridExtent::hemisphere), 1.6);
    EXPECT_NEAR(size(GridKind::latitude_longitude, GridExtent::sphere), 6.2, 0.15);
    EXPECT_NEAR(size(GridKind::latitude_longitude, GridExtent::hemisphere), 3.1, 0.2);
  }
}

TEST(DirectionGrid, NoTwoDirectionsCoincide) {
  for (const GridKind kind : {GridKind::geodesic, GridKind::latitude_longitude}) {
    const DirectionGrid grid = *direction_grid(kind, 0.05);
    for (std::size_t i = 0; i < grid.directions.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) EXPECT_LT(grid.directions[i].dot(grid.directions[j]), 1 - 1e-6);
    }
  }
}

TEST(DirectionGrid, Refusals) {
  for (const double delta : {0.0, -1.0, 1.5, std::nan("")}) {
    const auto refused = direction_grid(GridKind::geodesic, delta);
    ASSERT_FALSE(refused.has_value());
    EXPECT_EQ(refused.error().code, ErrorCode::bad_value);
    EXPECT_EQ(refused.error().where, "delta");
  }
  for (const GridKind kind : {GridKind::geodesic, GridKind::latitude_longitude}) {
    EXPECT_EQ(direction_grid(kind, 1e-3, GridExtent::sphere, 1000).error().code, ErrorCode::limit_exceeded);
    EXPECT_EQ(direction_grid(kind, 1e-300).error().code, ErrorCode::limit_exceeded);
    EXPECT_EQ(direction_grid(kind, 5e-324).error().code, ErrorCode::limit_exceeded);
  }
}

TEST(DirectionGrid, NumbersOfStepsStayInRange) {
  for (const GridKind kind : {GridKind::geodesic, GridKind::latitude_longitude}) {
    for (const double delta : {1e-12, 1e-300, 5e-324}) {
      const auto grid = direction_grid(kind, delta, GridExtent::sphere, std::numeric_limits<std::int64_t>::max());
      ASSERT_FALSE(grid);
      EXPECT_EQ(grid.error().code, ErrorCode::limit_exceeded);
    }
  }
}

}  // namespace
}  // namespace pd
