/// @file
/// The brute-force count of facets near the origin: polygons by hand, and the facets of the difference when built.
#include "bench/agarwal/near_facets.hpp"

#include <gtest/gtest.h>

#include "pd/depth/minkowski_difference.hpp"

namespace pd::bench {
namespace {

TEST(NearFacets, DistanceOfAPolygon) {
  const std::vector<Vec3> square = {{-1, -1, 3}, {1, -1, 3}, {1, 1, 3}, {-1, 1, 3}};
  EXPECT_DOUBLE_EQ(squared_distance_from_origin(square), 9);
  // Its plane passes the origin at 3, the square itself does not come near that.
  const std::vector<Vec3> aside = {{4, -1, 3}, {6, -1, 3}, {6, 1, 3}, {4, 1, 3}};
  EXPECT_DOUBLE_EQ(squared_distance_from_origin(aside), 25);
  const std::vector<Vec3> turned(square.rbegin(), square.rend());
  EXPECT_DOUBLE_EQ(squared_distance_from_origin(turned), 9);
}

TEST(NearFacets, CountsThoseOfTheBuiltDifference) {
  for (const scenes::AgarwalFamily family : {scenes::AgarwalFamily::sphere_hulls, scenes::AgarwalFamily::balls,
                                             scenes::AgarwalFamily::fogel_halperin_weibel}) {
    const scenes::PolytopePair pair = scenes::make_agarwal_pair(family, 24, scenes::DepthClass::mid, 3);
    const auto built = minkowski_difference(pair.a, pair.pose_a, pair.b, pair.pose_b);
    ASSERT_TRUE(built.has_value());
    for (const double radius : {0.01, 0.2, 0.7, 1.5, 10.0}) {
      std::int64_t expected = 0;
      for (const MinkowskiDifference::Facet& facet : built->facets) {
        std::vector<Vec3> corners;
        for (std::int32_t i = facet.first; i < facet.first + facet.count; ++i) {
          const std::int32_t vertex = built->corners[static_cast<std::size_t>(i)];
          corners.push_back(built->vertices[static_cast<std::size_t>(vertex)].position);
        }
        expected += squared_distance_from_origin(corners) <= radius * radius ? 1 : 0;
      }
      EXPECT_EQ(count_near_facets(pair, radius), expected) << to_string(family) << " " << radius;
    }
  }
}

}  // namespace
}  // namespace pd::bench
