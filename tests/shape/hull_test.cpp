/// ConvexPolytope::from_points and box: every affine dimension, exact combinatorics, one storage for every order.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>

#include "pd/shape/convex_polytope.hpp"
#include "pd/shape/verify.hpp"
#include "shape/exact_hull.hpp"
#include "shape/point_clouds.hpp"

namespace pd {
namespace {

using test::Points;

ConvexPolytope hull(const Points& points) {
  auto built = ConvexPolytope::from_points(points);
  EXPECT_TRUE(built.has_value());
  EXPECT_EQ(verify_polytope(*built), "");
  return *built;
}

template <class T>
bool same_bytes(const T* a, const T* b, int count) {
  return std::memcmp(a, b, sizeof(T) * static_cast<std::size_t>(count)) == 0;
}

/// All arrays but the caller ids.
bool same_bits(const ConvexPolytope& p, const ConvexPolytope& q) {
  if (p.num_vertices() != q.num_vertices() || p.num_half_edges() != q.num_half_edges() ||
      p.num_facets() != q.num_facets() || p.memory_bytes() != q.memory_bytes()) {
    return false;
  }
  bool same = same_bytes(p.x(), q.x(), p.padded_size()) && same_bytes(p.y(), q.y(), p.padded_size()) &&
              same_bytes(p.z(), q.z(), p.padded_size());
  for (int h = 0; h < p.num_half_edges(); ++h) same = same && p.half_edge(h) == q.half_edge(h);
  for (int f = 0; f < p.num_facets(); ++f) {
    const auto a = p.facet_vertices(f);
    const auto b = q.facet_vertices(f);
    same = same && std::ranges::equal(a, b) && same_bytes(p.facet_normal(f).data(), q.facet_normal(f).data(), 3);
  }
  return same;
}

TEST(Hull, Point) {
  const ConvexPolytope p = hull({{1, 2, 3}, {1, 2, 3}});
  EXPECT_EQ(p.affine_dimension(), 0);
  EXPECT_EQ(p.num_vertices(), 1);
  EXPECT_EQ(p.caller_id(0), 0);
  EXPECT_EQ(p.vertex(0), Vec3(1, 2, 3));
  EXPECT_TRUE(p.neighbours(0).empty());
}

TEST(Hull, Segment) {
  const ConvexPolytope p = hull({{0.2, 0.4, 0.6}, {0.1, 0.2, 0.3}, {0, 0, 0}, {0.1, 0.2, 0.3}});
  EXPECT_EQ(p.affine_dimension(), 1);
  EXPECT_EQ(p.num_vertices(), 2);
  EXPECT_EQ(p.caller_id(0), 2);
  EXPECT_EQ(p.caller_id(1), 0);
  EXPECT_EQ(p.num_edges(), 1);
  EXPECT_EQ(p.half_edge(0).facet, -1);
  EXPECT_EQ(p.target(0), 1);
}

TEST(Hull, PolygonIsDoublyCovered) {
  for (int axis = 0; axis < 3; ++axis) {
    Points points;
    for (const auto& [u, v] : {std::pair{0.0, 0.0}, {2.0, 0.0}, {2.0, 2.0}, {0.0, 2.0}, {1.0, 1.0}, {1.0, 0.0}}) {
      Vec3 q = Vec3::Constant(5);
      q[(axis + 1) % 3] = u;
      q[(axis + 2) % 3] = v;
      points.push_back(q);
    }
    const ConvexPolytope p = hull(points);
    EXPECT_EQ(p.affine_dimension(), 2);
    EXPECT_EQ(p.num_vertices(), 4);
    EXPECT_EQ(p.num_edges(), 4);
    EXPECT_EQ(p.num_facets(), 2);
    EXPECT_EQ(p.facet_normal(0), -p.facet_normal(1));
    EXPECT_EQ(std::abs(p.facet_normal(0)[axis]), 1);
  }
}

TEST(Hull, TiltedPolygonOfManyPoints) {
  // x + y + z = 0 exactly, on integers.
  Points points;
  for (int i = -40; i <= 40; ++i) {
    for (int j = -40; j <= 40; ++j) points.emplace_back(i, j, -i - j);
  }
  const ConvexPolytope p = hull(test::shuffled(points, 1));
  EXPECT_EQ(p.affine_dimension(), 2);
  EXPECT_EQ(p.num_vertices(), 4);
}

TEST(Hull, VerticalPlanes) {
  // y = x and z = 2 y planes: only some projections are one to one.
  Points upright;
  Points leaning;
  for (int i = 0; i < 9; ++i) {
    for (int j = 0; j < 9; ++j) {
      upright.emplace_back(i, i, (j * j) % 7);
      leaning.emplace_back(j - i, i, 2 * i);
    }
  }
  for (const Points& points : {upright, leaning}) {
    const ConvexPolytope p = hull(points);
    EXPECT_EQ(p.affine_dimension(), 2);
    EXPECT_EQ(p.num_vertices(), 4);
  }
}

TEST(Hull, TrianglesAreOneInEveryOrder) {
  const double ulp = 0x1p-52;
  const Points triangles[] = {{{0.3, 0.1, -0.2}, {0.9, -0.4, 0.5}, {-0.1, 0.8, 0.7}},
                              {{2, 0, 0}, {2, 1, -0.0}, {2, 0.0, 1}},
                              {{1e290, 0, 1}, {-1e290, 1, 0}, {3e289, 1e290, 1e-300}},
                              {{1e-310, 0, 0}, {0, 2e-310, 0}, {0, 0, 5e-324}},
                              {{0, 0, 0}, {1, 1, 1}, {0.5, 0.5, 0.5 + ulp}}};
  for (const Points& corners : triangles) {
    // With a corner twice it goes by way of the search.
    const ConvexPolytope searched = hull({corners[0], corners[1], corners[2], corners[1]});
    ASSERT_EQ(searched.num_vertices(), 3);
    int order[] = {0, 1, 2};
    do {
      const ConvexPolytope p = hull({corners[order[0]], corners[order[1]], corners[order[2]]});
      EXPECT_EQ(p.affine_dimension(), 2);
      EXPECT_TRUE(same_bits(p, searched));
      for (int v = 0; v < 3; ++v) EXPECT_EQ(order[p.caller_id(v)], searched.caller_id(v));
    } while (std::next_permutation(order, order + 3));
  }
  const ConvexPolytope flat = hull({{0.1, 0.2, 0.3}, {0.2, 0.4, 0.6}, {0, 0, 0}});
  EXPECT_EQ(flat.affine_dimension(), 1);
  EXPECT_EQ(hull({{1, 2, 3}, {4, 5, 6}, {1, 2, 3}}).affine_dimension(), 1);
  EXPECT_EQ(hull({{1, 2, 3}, {1, 2, 3}, {1, 2, 3}}).affine_dimension(), 0);
}

TEST(Hull, BoxIdsAreBits) {
  const auto box = ConvexPolytope::box({1, 2, 3});
  ASSERT_TRUE(box.has_value());
  EXPECT_EQ(verify_polytope(*box), "");
  EXPECT_EQ(box->num_vertices(), 8);
  EXPECT_EQ(box->num_edges(), 12);
  EXPECT_EQ(box->num_facets(), 6);
  for (int v = 0; v < 8; ++v) {
    const Vec3 p = box->vertex(v);
    EXPECT_EQ(box->caller_id(v), (p.x() > 0 ? 1 : 0) + (p.y() > 0 ? 2 : 0) + (p.z() > 0 ? 4 : 0));
  }
  for (int f = 0; f < 6; ++f) EXPECT_EQ(box->facet_normal(f).cwiseAbs().sum(), 1);
}

TEST(Hull, OfTheCornersOfABox) {
  std::uint64_t state = 5;
  for (const Vec3& size : {Vec3(1, 2, 3), Vec3(0.1, 0.1, 0.1), Vec3(5e-324, 1, 1e300), Vec3(1e-310, 2e-310, 3e-310),
                           Vec3(1e300, 1e300, 1e300), Vec3(0.3f, 0.7f, 19.96f)}) {
    for (const double from : {-1.0, 0.0, -0.0}) {
      Points corners;
      for (unsigned i = 0; i < 8; ++i) {
        corners.emplace_back((i & 1) != 0 ? size.x() : from * size.x(), (i & 2) != 0 ? size.y() : from * size.y(),
                             (i & 4) != 0 ? size.z() : from * size.z());
      }
      for (std::size_t i = 8; i > 1; --i) {
        state = state * 6364136223846793005ULL + 1442695040888963407ULL;
        std::swap(corners[i - 1], corners[(state >> 33) % i]);
      }
      const ConvexPolytope box = hull(corners);
      ASSERT_EQ(box.num_vertices(), 8);
      // With a corner twice it goes by way of the search.
      corners.push_back(corners[state % 8]);
      const ConvexPolytope searched = hull(corners);
      EXPECT_TRUE(same_bits(box, searched));
      EXPECT_EQ(box.storage().second_moments, searched.storage().second_moments);
      for (int v = 0; v < 8; ++v) {
        EXPECT_EQ(corners[static_cast<std::size_t>(box.caller_id(v))], box.vertex(v));
        EXPECT_FALSE(std::signbit(box.vertex(v).x()) && box.vertex(v).x() == 0);
      }
    }
  }
  // Eight points of which two are one, and seven corners beside a point on an edge.
  EXPECT_EQ(
      hull({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {0, 1, 1}}).num_vertices(), 7);
  EXPECT_EQ(
      hull({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {0.5, 0, 0}}).num_vertices(),
      7);
}

TEST(Hull, BoxRefusals) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(ConvexPolytope::box({1, nan, 1}).error().code, ErrorCode::non_finite);
  EXPECT_EQ(ConvexPolytope::box({1, 1, 0}).error().code, ErrorCode::bad_value);
  EXPECT_EQ(ConvexPolytope::box({1, 1, 0}).error().where, "half_extents[2]");
  EXPECT_EQ(ConvexPolytope::box({-1, 1, 1}).error().code, ErrorCode::bad_value);
  EXPECT_EQ(ConvexPolytope::box({1e301, 1, 1}).error().code, ErrorCode::out_of_range);
  const auto tiny = ConvexPolytope::box({5e-324, 1, 1});
  ASSERT_TRUE(tiny.has_value());
  EXPECT_EQ(verify_polytope(*tiny), "");
  EXPECT_EQ(tiny->num_facets(), 6);
}

TEST(Hull, Refusals) {
  EXPECT_EQ(ConvexPolytope::from_points({}).error().code, ErrorCode::too_few_points);
  Points points = test::box_cloud(20, 1);
  points[7].y() = std::numeric_limits<double>::infinity();
  points[9].y() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(ConvexPolytope::from_points(points).error().code, ErrorCode::non_finite);
  EXPECT_EQ(ConvexPolytope::from_points(points).error().where, "vertices[7]");
  points[7].y() = -2e300;
  EXPECT_EQ(ConvexPolytope::from_points(points).error().code, ErrorCode::out_of_range);
  // Large sets are surveyed another way and must say the same.
  Points many = test::box_cloud(100000, 1);
  many[77777].z() = std::numeric_limits<double>::quiet_NaN();
  many[88888].z() = 1e301;
  EXPECT_EQ(ConvexPolytope::from_points(many).error().where, "vertices[77777]");
  many[77777].z() = 0;
  EXPECT_EQ(ConvexPolytope::from_points(many).error().where, "vertices[88888]");
  EXPECT_EQ(ConvexPolytope::from_points(many).error().code, ErrorCode::out_of_range);
}

TEST(Hull, DuplicatesGiveTheLowestId) {
  Points once = test::sphere_cloud(3000, 3);
  Points points = test::box_cloud(500, 4);
  for (Vec3& p : points) p *= 0.1;
  points.insert(points.end(), once.begin(), once.end());
  points.insert(points.end(), once.begin(), once.end());
  const ConvexPolytope p = hull(points);
  ASSERT_EQ(p.num_vertices(), 3000);
  for (int v = 0; v < p.num_vertices(); ++v) {
    EXPECT_GE(p.caller_id(v), 500);
    EXPECT_LT(p.caller_id(v), 3500);
    EXPECT_EQ(p.vertex(v), points[static_cast<std::size_t>(p.caller_id(v))]);
  }
}

TEST(Hull, NegativeZeroIsZero) {
  const ConvexPolytope p = hull({{0.0, 0, 0}, {-0.0, 1, -0.0}, {-0.0, -0.0, -0.0}, {1, -0.0, 0}, {0, 0, 1}});
  EXPECT_EQ(p.num_vertices(), 4);
  for (int v = 0; v < 4; ++v) {
    for (int i = 0; i < 3; ++i) EXPECT_FALSE(std::signbit(p.vertex(v)[i]));
  }
}

TEST(Hull, AgreesWithRationalOracleOnSmallIntegers) {
  // Few distinct coordinates: nearly every set is full of coplanar, collinear and coincident points.
  std::mt19937_64 random(7);
  int solids = 0;
  for (int round = 0; round < 400; ++round) {
    const int n = 4 + round % 11;
    const int range = 1 + round % 3;
    std::uniform_int_distribution<int> coordinate(-range, range);
    Points points;
    for (int i = 0; i < n; ++i) {
      const int x = coordinate(random);
      const int y = coordinate(random);
      points.emplace_back(x, y, coordinate(random));
    }
    const ConvexPolytope p = hull(points);
    if (p.affine_dimension() < 3) continue;
    ++solids;
    const test::ExactHull expected = test::exact_hull(points);
    const test::ExactHull found = test::combinatorics(p);
    ASSERT_EQ(found.vertices, expected.vertices) << "round " << round;
    ASSERT_EQ(found.facets, expected.facets) << "round " << round;
  }
  EXPECT_GT(solids, 250);
}

TEST(Hull, AgreesWithRationalOracleOnRotatedIntegers) {
  // The same sets turned by a rounded rotation: almost coplanar now, and every last bit counts.
  Mat3 turn;
  turn << 0.6, -0.8, 0, 0.48, 0.36, -0.8, 0.64, 0.48, 0.6;
  std::mt19937_64 random(8);
  std::uniform_int_distribution<int> coordinate(-2, 2);
  for (int round = 0; round < 200; ++round) {
    Points points;
    for (int i = 0; i < 12; ++i) {
      const int x = coordinate(random);
      const int y = coordinate(random);
      points.push_back(turn * (Vec3(x, y, coordinate(random)) * 0.1));
    }
    const ConvexPolytope p = hull(points);
    if (p.affine_dimension() < 3) continue;
    const test::ExactHull expected = test::exact_hull(points);
    const test::ExactHull found = test::combinatorics(p);
    ASSERT_EQ(found.vertices, expected.vertices) << "round " << round;
    ASSERT_EQ(found.facets, expected.facets) << "round " << round;
  }
}

TEST(Hull, Lattices) {
  Mat3 integer_map;
  integer_map << 3, 7, 0, -9, 1, 2, 1, 0, 77;
  for (const Mat3& map : {Mat3(Mat3::Identity()), integer_map}) {
    for (const int k : {2, 3, 10, 46}) {
      const ConvexPolytope p = hull(test::lattice(k, map));
      EXPECT_EQ(p.num_vertices(), 8);
      EXPECT_EQ(p.num_facets(), 6);
      EXPECT_EQ(p.num_edges(), 12);
    }
  }
  // Rounded coordinates: the sides are no planes any more, and the hull is that of the rounded numbers.
  Mat3 rounded_map;
  rounded_map << 0.3, 0.7, 0, -0.9, 0.1, 0.2, 0.1, 0, 0.77;
  const ConvexPolytope p = hull(test::lattice(20, rounded_map));
  EXPECT_GT(p.num_vertices(), 8);
}

TEST(Hull, PointsOnTheSidesOfACube) {
  Points points = test::cube_sides(20000, 11);
  const ConvexPolytope without_corners = hull(points);
  EXPECT_GT(without_corners.num_vertices(), 50);
  for (int corner = 0; corner < 8; ++corner) {
    points.emplace_back((corner & 1) != 0 ? 1 : -1, (corner & 2) != 0 ? 1 : -1, (corner & 4) != 0 ? 1 : -1);
  }
  const ConvexPolytope p = hull(points);
  EXPECT_EQ(p.num_vertices(), 8);
  EXPECT_EQ(p.num_facets(), 6);
}

TEST(Hull, Cospherical) {
  // All points are vertices; facets are large coplanar groups, among them those of the symmetry axes.
  for (const int squared_radius : {3, 9, 41, 101, 1001, 5005}) {
    const Points points = test::cospherical(squared_radius);
    const ConvexPolytope p = hull(points);
    EXPECT_EQ(p.num_vertices(), static_cast<int>(points.size()));
    EXPECT_TRUE(same_bits(p, hull(test::shuffled(points, 2))));
  }
  EXPECT_EQ(hull(test::cospherical(3)).num_facets(), 6);
}

TEST(Hull, OrderOfPointsDoesNotMatter) {
  Mat3 map;
  map << 0.3, 0.7, 0, -0.9, 0.1, 0.2, 0.1, 0, 0.77;
  const std::vector<Points> sets = {test::box_cloud(300, 1),
                                    test::ball_cloud(20000, 2),
                                    test::sphere_cloud(5000, 3),
                                    test::cube_sides(10000, 4),
                                    test::lattice(12, map),
                                    test::box_cloud(200000, 5),
                                    test::lattice(40, Mat3::Identity())};
  for (const Points& points : sets) {
    const ConvexPolytope reference = hull(points);
    for (unsigned seed = 1; seed <= 3; ++seed) {
      const Points other = test::shuffled(points, seed);
      const ConvexPolytope p = hull(other);
      EXPECT_TRUE(same_bits(reference, p));
      for (int v = 0; v < p.num_vertices(); ++v) {
        EXPECT_EQ(p.vertex(v), other[static_cast<std::size_t>(p.caller_id(v))]);
      }
    }
  }
}

TEST(Hull, PowersOfTwoChangeNothing) {
  const Points points = test::sphere_cloud(100, 21);
  const ConvexPolytope reference = hull(points);
  for (const int exponent : {-900, -300, -40, 40, 300, 900}) {
    Points other = points;
    for (Vec3& p : other) p *= std::ldexp(1.0, exponent);
    const ConvexPolytope p = hull(other);
    ASSERT_EQ(p.num_vertices(), reference.num_vertices());
    ASSERT_EQ(p.num_facets(), reference.num_facets());
    for (int f = 0; f < p.num_facets(); ++f) {
      const auto a = p.facet_vertices(f);
      const auto b = reference.facet_vertices(f);
      ASSERT_TRUE(std::equal(a.begin(), a.end(), b.begin(), b.end()));
      ASSERT_EQ(p.facet_normal(f), reference.facet_normal(f));
    }
  }
}

TEST(Hull, MagnitudesThatSpanTheWholeRange) {
  // A needle from 1e-300 to 1e300 with a cross-section that no scaling keeps.
  const Points points = {{1e300, 0, 0}, {-1e300, 1e-300, 0}, {0, 3e-300, 5e-324}, {0, 0, 1e-290}, {1, -1e-300, 0}};
  const ConvexPolytope p = hull(points);
  EXPECT_EQ(p.affine_dimension(), 3);
  const test::ExactHull expected = test::exact_hull(points);
  EXPECT_EQ(test::combinatorics(p).vertices, expected.vertices);
  EXPECT_EQ(test::combinatorics(p).facets, expected.facets);
  std::mt19937_64 random(31);
  std::uniform_int_distribution<int> exponent(-1070, 990);
  for (int round = 0; round < 4; ++round) {
    Points wild;
    for (int i = 0; i < 10; ++i) {
      Vec3 q;
      for (int k = 0; k < 3; ++k) {
        const double fraction =
            test::uniform(random);  // one draw a statement: the order of arguments is the compiler's
        q[k] = std::ldexp(fraction, exponent(random));
      }
      wild.push_back(q);
    }
    const ConvexPolytope w = hull(wild);
    const test::ExactHull oracle = test::exact_hull(wild);
    ASSERT_EQ(test::combinatorics(w).vertices, oracle.vertices);
    ASSERT_EQ(test::combinatorics(w).facets, oracle.facets);
  }
}

TEST(Hull, ClustersWhoseProductsUnderflow) {
  // Facets among points 2^-537 apart have normals of a few of the least numbers; on which side of them the far points
  // lie, products of such say only up to a few of those.
  std::mt19937_64 random(33);
  std::uniform_int_distribution<int> coordinate(-4, 4);
  for (int round = 0; round < 40; ++round) {
    Points points{{1, 0.3, 0.2}, {0.2, 1, 0.3}, {0.3, 0.2, 1}};
    for (int i = 0; i < 8; ++i) {
      const int x = coordinate(random);
      const int y = coordinate(random);
      points.push_back(0x1p-537 * Vec3(x, y, coordinate(random)));
    }
    const ConvexPolytope p = hull(points);
    const test::ExactHull expected = test::exact_hull(points);
    ASSERT_EQ(test::combinatorics(p).vertices, expected.vertices) << "round " << round;
    ASSERT_EQ(test::combinatorics(p).facets, expected.facets) << "round " << round;
  }
}

TEST(Hull, SubnormalCoordinates) {
  Points points;
  for (int corner = 0; corner < 8; ++corner) {
    points.emplace_back((corner & 1) * 5e-324, ((corner >> 1) & 1) * 5e-324, ((corner >> 2) & 1) * 5e-324);
  }
  const ConvexPolytope p = hull(points);
  EXPECT_EQ(p.num_vertices(), 8);
  EXPECT_EQ(p.num_facets(), 6);
}

TEST(Hull, NormalsOfEdgesOfUnlikeLength) {
  // Well-conditioned planes whose cross products are tiny, or lost to underflow, next to the longest edge.
  for (const double tiny : {1e-100, 1e-160, 1e-250, 1e-300}) {
    const ConvexPolytope p = hull({{0, 0, 0}, {1, 0, 0}, {0.5, tiny, 0}, {0.5, 0, tiny}});
    ASSERT_EQ(p.num_facets(), 4);
    for (int f = 0; f < 4; ++f) {
      EXPECT_LE(std::abs(p.facet_normal(f).x()), 2 * tiny);
      EXPECT_GE(p.facet_normal(f).cwiseAbs().maxCoeff(), std::sqrt(0.5) - 1e-15);
    }
  }
}

TEST(Hull, NormalsOfSliversAreAccurate) {
  // A long thin facet: plain doubles would get its normal wrong by 1e-6.
  const double d = 1e-10;
  const Points points = {{0, 0, 0}, {1, 1, 1}, {2, 2, 2 + d}, {1, 1, 0}, {0.5, 0.5 + d, 0.5}};
  const ConvexPolytope p = hull(points);
  for (int f = 0; f < p.num_facets(); ++f) {
    for (const int v : p.facet_vertices(f)) {
      const Vec3 from = p.vertex(p.facet_vertices(f)[0]);
      EXPECT_NEAR(p.facet_normal(f).dot(p.vertex(v) - from), 0, 2e-15);
    }
  }
}

TEST(Hull, MemoryPerVertex) {
  const Points points = test::sphere_cloud(10000, 6);
  const ConvexPolytope p = hull(points);
  EXPECT_LE(static_cast<double>(p.memory_bytes()) / p.num_vertices(), 280);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(p.x()) % 64, 0U);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(p.y()) % 64, 0U);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(p.z()) % 64, 0U);
}

TEST(Hull, ConeOverAFineRing) {
  // An apex that sees a rim of thousands of edges.
  Points points;
  constexpr int n = 20000;
  for (int i = 0; i < n; ++i) points.emplace_back(std::cos(2 * M_PI * i / n), std::sin(2 * M_PI * i / n), 0);
  points.emplace_back(0, 0, 1);
  points.emplace_back(0, 0, 2);
  points.emplace_back(0, 0, -1);
  const ConvexPolytope p = hull(points);
  EXPECT_GT(p.num_vertices(), n / 2);
}

}  // namespace
}  // namespace pd
