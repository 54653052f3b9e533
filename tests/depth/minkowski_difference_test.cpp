/// @file
/// The built Minkowski difference against the hull of all differences of vertices.
#include "pd/depth/minkowski_difference.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <vector>

#include "oracle/wanted_cases.hpp"

namespace pd {
namespace {

std::vector<Vec3> all_differences(const ConvexPolytope& a, const Pose& pose_a, const ConvexPolytope& b,
                                  const Pose& pose_b) {
  std::vector<Vec3> points;
  for (int i = 0; i < a.num_vertices(); ++i) {
    for (int j = 0; j < b.num_vertices(); ++j) points.push_back(pose_b.apply(b.vertex(j)) - pose_a.apply(a.vertex(i)));
  }
  return points;
}

/// Facets as sets of corner positions, order-free.
using Shape = std::vector<std::vector<std::array<double, 3>>>;

std::array<double, 3> key(const Vec3& v) { return {v.x() + 0.0, v.y() + 0.0, v.z() + 0.0}; }

void rotate_to_least(std::vector<std::array<double, 3>>& loop) {
  std::rotate(loop.begin(), std::min_element(loop.begin(), loop.end()), loop.end());
}

Shape shape_of(const MinkowskiDifference& difference) {
  Shape shape;
  for (const MinkowskiDifference::Facet& facet : difference.facets) {
    std::vector<std::array<double, 3>> loop;
    for (std::int32_t i = 0; i < facet.count; ++i) {
      const std::int32_t v = difference.corners[static_cast<std::size_t>(facet.first + i)];
      loop.push_back(key(difference.vertices[static_cast<std::size_t>(v)].position));
    }
    rotate_to_least(loop);
    shape.push_back(loop);
  }
  std::sort(shape.begin(), shape.end());
  return shape;
}

Shape shape_of(const ConvexPolytope& polytope) {
  Shape shape;
  for (int f = 0; f < polytope.num_facets(); ++f) {
    std::vector<std::array<double, 3>> loop;
    for (const std::int32_t v : polytope.facet_vertices(f)) loop.push_back(key(polytope.vertex(v)));
    rotate_to_least(loop);
    shape.push_back(loop);
  }
  std::sort(shape.begin(), shape.end());
  return shape;
}

/// Every edge twice, once each way; Euler's formula.
void expect_closed(const MinkowskiDifference& difference) {
  std::map<std::pair<std::int32_t, std::int32_t>, int> edges;
  for (const MinkowskiDifference::Facet& facet : difference.facets) {
    for (std::int32_t i = 0; i < facet.count; ++i) {
      const std::int32_t from = difference.corners[static_cast<std::size_t>(facet.first + i)];
      const std::int32_t to = difference.corners[static_cast<std::size_t>(facet.first + (i + 1) % facet.count)];
      ++edges[{from, to}];
    }
  }
  for (const auto& [edge, count] : edges) {
    EXPECT_EQ(count, 1);
    EXPECT_EQ(edges.count({edge.second, edge.first}), 1u);
  }
  EXPECT_EQ(static_cast<std::int64_t>(difference.vertices.size()) - static_cast<std::int64_t>(edges.size()) / 2 +
                difference.num_facets(),
            2);
}

/// No point is beyond a facet's plane, and the facet's corners are points: with a closed surface, that of their hull.
/// Exact for small whole numbers.
void expect_nothing_outside(const MinkowskiDifference& difference, const std::vector<Vec3>& points) {
  for (const MinkowskiDifference::Facet& facet : difference.facets) {
    const auto corner = [&](std::int32_t i) {
      const std::int32_t v = difference.corners[static_cast<std::size_t>(facet.first + i)];
      return difference.vertices[static_cast<std::size_t>(v)].position;
    };
    const Vec3 normal = (corner(1) - corner(0)).cross(corner(2) - corner(0));
    EXPECT_NE(normal, Vec3::Zero());
    for (std::int32_t i = 0; i < facet.count; ++i) {
      EXPECT_EQ(normal.dot(corner(i) - corner(0)), 0);
      EXPECT_NE(std::find(points.begin(), points.end(), corner(i)), points.end());
    }
    for (const Vec3& x : points) EXPECT_LE(normal.dot(x - corner(0)), 0);
  }
}

ConvexPolytope grid_body(std::mt19937_64& random, int constant) {
  std::uniform_int_distribution<int> coordinate(-2, 2);
  std::vector<Vec3> points;
  const int n = 1 + static_cast<int>(random() % 9);
  for (int i = 0; i < n; ++i) {
    Vec3 p = Eigen::Vector3i{coordinate(random), coordinate(random), coordinate(random)}.cast<double>();
    if (constant < 3) p[constant] = 1;
    points.push_back(p);
  }
  return *ConvexPolytope::from_points(points);
}

TEST(MinkowskiDifference, GridBodiesEqualTheHullOfAllDifferences) {
  std::mt19937_64 random(test::wanted_seed(41));
  int dimensions[4] = {0, 0, 0, 0};
  for (int round = 0; round < test::wanted_cases("PD_DIFFERENCE_CASES", 1500) && !HasFailure(); ++round) {
    SCOPED_TRACE(round);
    const ConvexPolytope a = grid_body(random, static_cast<int>(random() % 5));
    const ConvexPolytope b = grid_body(random, static_cast<int>(random() % 5));
    const Pose pose = *Pose::from_matrix(Mat3::Identity(), Vec3(1, 2, -1));
    const auto difference = minkowski_difference(a, pose, b, Pose());
    ASSERT_TRUE(difference.has_value());
    const ConvexPolytope expected = *ConvexPolytope::from_points(all_differences(a, pose, b, Pose()));
    ASSERT_EQ(difference->affine_dimension, expected.affine_dimension());
    ++dimensions[difference->affine_dimension];
    ASSERT_EQ(static_cast<int>(difference->vertices.size()), expected.num_vertices());
    if (difference->affine_dimension == 3) {
      EXPECT_EQ(shape_of(*difference), shape_of(expected));
      expect_closed(*difference);
      expect_nothing_outside(*difference, all_differences(a, pose, b, Pose()));
      continue;
    }
    std::vector<std::array<double, 3>> found, wanted;
    for (const auto& v : difference->vertices) found.push_back(key(v.position));
    for (int v = 0; v < expected.num_vertices(); ++v) wanted.push_back(key(expected.vertex(v)));
    std::sort(found.begin(), found.end());
    std::sort(wanted.begin(), wanted.end());
    EXPECT_EQ(found, wanted);
  }
  for (const int count : dimensions) EXPECT_GT(count, 5);
}

TEST(MinkowskiDifference, RandomPosedBodies) {
  std::mt19937_64 random(42);
  std::normal_distribution<double> normal;
  for (int round = 0; round < 60 && !HasFailure(); ++round) {
    std::vector<Vec3> pa, pb;
    for (int i = 0; i < 4 + round % 20; ++i) pa.push_back(Vec3{normal(random), normal(random), normal(random)});
    for (int i = 0; i < 4 + round % 30; ++i) pb.push_back(Vec3{normal(random), normal(random), normal(random)});
    const ConvexPolytope a = *ConvexPolytope::from_points(pa);
    const ConvexPolytope b = *ConvexPolytope::from_points(pb);
    const Pose pose = *Pose::from_quaternion({0.5, 0.5, -0.5, 0.5}, Vec3(normal(random), 1, 2));
    const auto difference = minkowski_difference(a, pose, b, Pose());
    ASSERT_TRUE(difference.has_value());
    expect_closed(*difference);
    for (const MinkowskiDifference::Facet& facet : difference->facets) {
      const std::int32_t corner = difference->corners[static_cast<std::size_t>(facet.first)];
      const double level = facet.normal.dot(difference->vertices[static_cast<std::size_t>(corner)].position);
      for (const auto& v : difference->vertices) EXPECT_LE(facet.normal.dot(v.position), level + 1e-12);
    }
  }
}

TEST(MinkowskiDifference, AlignedCubesHaveSixFacetsOfParallelPairs) {
  const ConvexPolytope cube = *ConvexPolytope::box(Vec3(1, 1, 1));
  const auto difference = minkowski_difference(cube, Pose(), cube, Pose());
  EXPECT_EQ(difference->num_facets(), 6);
  EXPECT_EQ(difference->vertices.size(), 8u);
  for (const auto& facet : difference->facets) EXPECT_EQ(to_string(facet.kind), "facet-facet");
}

TEST(MinkowskiDifference, RefusesWhatIsTooLarge) {
  const ConvexPolytope cube = *ConvexPolytope::box(Vec3(1, 1, 1));
  const auto refused = minkowski_difference(cube, Pose(), cube, Pose(), 5);
  ASSERT_FALSE(refused.has_value());
  EXPECT_EQ(refused.error().code, ErrorCode::limit_exceeded);
}

}  // namespace
}  // namespace pd
