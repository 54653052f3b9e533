// Solids of halfspaces: vertices against those worked out by hand or by the hull of points, exact ties, named refusals.
#include "pd/shape/halfspaces.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <set>

namespace {

using pd::ErrorCode;
using pd::Halfspace3;
using pd::polytope_of_halfspaces;
using pd::Vec3;
using Planes = std::vector<Halfspace3>;

Planes box(const Vec3& low, const Vec3& high) {
  Planes planes;
  for (int k = 0; k < 3; ++k) {
    planes.push_back({Vec3::Unit(k), high[k]});
    planes.push_back({-Vec3::Unit(k), -low[k]});
  }
  return planes;
}

std::set<std::array<double, 3>> vertices(const pd::ConvexPolytope& body) {
  std::set<std::array<double, 3>> r;
  for (int v = 0; v < body.num_vertices(); ++v) r.insert({body.vertex(v).x(), body.vertex(v).y(), body.vertex(v).z()});
  return r;
}

TEST(Halfspaces, ABoxHasItsCorners) {
  const auto body = polytope_of_halfspaces(box({-1, 0, 2}, {3, 0.1, 5}));
  ASSERT_TRUE(body);
  std::set<std::array<double, 3>> corners;
  for (const double x : {-1.0, 3.0}) {
    for (const double y : {0.0, 0.1}) {
      for (const double z : {2.0, 5.0}) corners.insert({x, y, z});
    }
  }
  EXPECT_EQ(vertices(*body), corners);
  EXPECT_EQ(body->num_facets(), 6);
}

TEST(Halfspaces, FourPlanesThroughOneVertexStayOne) {
  Planes octahedron;
  for (const double x : {-1.0, 1.0}) {
    for (const double y : {-1.0, 1.0}) {
      for (const double z : {-1.0, 1.0}) octahedron.push_back({{x, y, z}, 0.3});
    }
  }
  const auto body = polytope_of_halfspaces(octahedron);
  ASSERT_TRUE(body);
  EXPECT_EQ(body->num_vertices(), 6);
  EXPECT_EQ(body->num_facets(), 8);
}

TEST(Halfspaces, RedundantAndRepeatedOnesChangeNothing) {
  Planes planes = box({-1, -1, -1}, {1, 1, 1});
  const auto alone = vertices(*polytope_of_halfspaces(planes));
  planes.push_back({{4, 0, 0}, 4});    // the same plane, longer
  planes.push_back({{1, 1, 0}, 2});    // through an edge
  planes.push_back({{1, 1, 1}, 3});    // through a corner
  planes.push_back({{1, 2, 3}, 1e9});  // far away
  planes.push_back({{1, 0, 0}, 1.5});  // parallel, farther
  std::mt19937 random(1);
  for (int i = 0; i < 20; ++i) {
    std::shuffle(planes.begin(), planes.end(), random);
    EXPECT_EQ(vertices(*polytope_of_halfspaces(planes)), alone);
  }
}

TEST(Halfspaces, TheVerticesAreExactPointsRounded) {
  // x <= 1/3, y <= 1/7, z <= 1/10 by integer normals: the nearest doubles.
  Planes planes = {{{3, 0, 0}, 1}, {{0, 7, 0}, 1}, {{0, 0, 10}, 1}, {{-1, -1, -1}, 0}};
  const auto found = vertices(*polytope_of_halfspaces(planes));
  EXPECT_TRUE(found.contains({1.0 / 3, 1.0 / 7, 0.1}));
  EXPECT_EQ(found.size(), 4u);
}

/// Integer directions on a sphere: the halfspaces of the hull of random lattice points, which must come back.
TEST(Halfspaces, TheFacetsOfAHullGiveItsVerticesBack) {
  std::mt19937 random(7);
  std::uniform_int_distribution<int> whole(-8, 8);
  for (int round = 0; round < 60; ++round) {
    std::vector<Vec3> points;
    for (int i = 0; i < 4 + round; ++i)
      points.push_back(Eigen::Vector3i{whole(random), whole(random), whole(random)}.cast<double>());
    const auto hull = pd::ConvexPolytope::from_points(points);
    if (!hull || hull->affine_dimension() < 3) continue;
    Planes planes;
    for (int f = 0; f < hull->num_facets(); ++f) {
      const auto loop = hull->facet_vertices(f);
      const Vec3 a = hull->vertex(loop[0]), b = hull->vertex(loop[1]), c = hull->vertex(loop[2]);
      const Vec3 n = (b - a).cross(c - a);  // whole numbers: exact
      planes.push_back({n, n.dot(a)});
    }
    const auto back = polytope_of_halfspaces(planes);
    ASSERT_TRUE(back) << round << ": " << back.error().message;
    EXPECT_EQ(vertices(*back), vertices(*hull)) << round;
    EXPECT_EQ(back->num_facets(), hull->num_facets());
  }
}

TEST(Halfspaces, RandomPlanesEncloseAndAreReached) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  for (const int n : {24, 100, 300}) {
    Planes planes;
    for (int i = 0; i < n; ++i) {
      planes.push_back({Vec3{normal(random), normal(random), normal(random)}, 0});
      planes.back().offset = planes.back().normal.norm() + planes.back().normal.x() * 5;  // about (5, 0, 0)
    }
    const auto body = polytope_of_halfspaces(planes);
    ASSERT_TRUE(body) << body.error().message;
    EXPECT_EQ(body->num_vertices(), 2 * n - 4);  // simple, and every plane of a ball's tangents bounds it
    for (const Halfspace3& h : planes) {
      double most = -1e300;
      for (int v = 0; v < body->num_vertices(); ++v) most = std::max(most, h.normal.dot(body->vertex(v)));
      EXPECT_NEAR(most, h.offset, 1e-12 * (1 + std::abs(h.offset)) * body->radius());
    }
  }
}

TEST(Halfspaces, AnySizeOfNumbers) {
  for (const double scale : {1e-90, 1e-3, 1e90}) {
    Planes planes = box({-1, -1, -1}, {1, 1, 1});
    for (Halfspace3& h : planes) h.normal *= scale;
    const auto body = polytope_of_halfspaces(planes);
    ASSERT_TRUE(body) << body.error().message;
    EXPECT_EQ(body->num_vertices(), 8);
  }
}

TEST(Halfspaces, RefusalsByName) {
  const auto code = [](const Planes& planes) {
    const auto body = polytope_of_halfspaces(planes);
    EXPECT_FALSE(body);
    return body ? ErrorCode::unsupported : body.error().code;
  };
  Planes planes = box({-1, -1, -1}, {1, 1, 1});
  Planes open(planes.begin(), planes.end() - 1);
  EXPECT_EQ(code(open), ErrorCode::unbounded);
  EXPECT_EQ(code({planes.begin(), planes.begin() + 3}), ErrorCode::too_few_points);
  EXPECT_EQ(code({{{1, 0, 0}, 0}, {{0, 1, 0}, 0}, {{0, 0, 1}, 0}, {{1, 1, 1}, 0}}), ErrorCode::unbounded);  // a cone
  EXPECT_EQ(code(box({1, 0, 0}, {0, 1, 1})), ErrorCode::bad_value);                                         // empty
  EXPECT_EQ(code(box({0, 0, 0}, {1, 1, 0})), ErrorCode::not_full_dimensional);                              // a square
  EXPECT_EQ(code(box({0, 0, 0}, {0, 0, 0})), ErrorCode::bad_value);                                         // a point
  const auto with = [&](const Halfspace3& h) {
    Planes more = planes;
    more.push_back(h);
    const auto body = polytope_of_halfspaces(more);
    EXPECT_FALSE(body);
    EXPECT_EQ(body.error().where, "planes[6]");
    return body.error().code;
  };
  EXPECT_EQ(with({{0, 0, 0}, 1}), ErrorCode::zero_direction);
  EXPECT_EQ(with({{1, 0, 0}, std::nan("")}), ErrorCode::non_finite);
  EXPECT_EQ(with({{1e200, 0, 0}, 1}), ErrorCode::out_of_range);
  EXPECT_EQ(code(Planes(8193, planes[0])), ErrorCode::limit_exceeded);
}

}  // namespace
