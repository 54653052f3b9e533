/// @file
/// The overlay of two normal diagrams against brute force: every facet of P = B + (-A) once, in general and in every
/// kind of degenerate position.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <random>
#include <set>
#include <vector>

#include "structure/overlay/face_sum.hpp"
#include "structure/overlay/overlay_walk.hpp"

namespace pd::detail {
namespace {

ConvexPolytope hull(const std::vector<Vec3>& points) {
  Expected<ConvexPolytope> polytope = ConvexPolytope::from_points(points);
  EXPECT_TRUE(polytope.has_value());
  return *polytope;
}

std::vector<Vec3> sphere_points(int n, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  std::vector<Vec3> points;
  for (int i = 0; i < n; ++i) points.push_back(Vec3{normal(random), normal(random), normal(random)}.normalized());
  return points;
}

Pose random_pose(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  std::array<double, 4> q{normal(random), normal(random), normal(random), normal(random)};
  const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  for (double& c : q) c /= length;
  return *Pose::from_quaternion(q, 0.3 * Vec3{normal(random), normal(random), normal(random)});
}

std::vector<OverlayPiece> pieces_of(const PosedPair& pair, OverlayBuffers& buffers) {
  std::vector<OverlayPiece> pieces;
  OverlayWalk walk(pair, buffers);
  walk.run([&](std::span<const OverlayPiece> block) {
    pieces.insert(pieces.end(), block.begin(), block.end());
    return true;
  });
  return pieces;
}

/// Number of crossing arcs by testing all pairs of edges in doubles.
std::int64_t brute_force_crossings(const ConvexPolytope& a, const Pose& pose_a, const ConvexPolytope& b,
                                   const Pose& pose_b) {
  const auto normal = [](const ConvexPolytope& p, const Pose& pose, int f) {
    const auto loop = p.facet_vertices(f);
    const Vec3 o = p.vertex(loop[0]);
    return Vec3(pose.rotation() * (p.vertex(loop[1]) - o).cross(p.vertex(loop[2]) - o));
  };
  std::int64_t count = 0;
  for (int h = 0; h < a.num_half_edges(); ++h) {
    if (a.half_edge(h).twin < h) continue;
    const Vec3 e = pose_a.rotation() * (a.vertex(a.target(h)) - a.vertex(a.half_edge(h).origin));
    const Vec3 n0 = -normal(a, pose_a, a.half_edge(h).facet);
    const Vec3 n1 = -normal(a, pose_a, a.half_edge(a.half_edge(h).twin).facet);
    for (int g = 0; g < b.num_half_edges(); ++g) {
      if (b.half_edge(g).twin < g) continue;
      const Vec3 w = pose_b.rotation() * (b.vertex(b.target(g)) - b.vertex(b.half_edge(g).origin));
      const Vec3 m0 = normal(b, pose_b, b.half_edge(g).facet);
      const Vec3 m1 = normal(b, pose_b, b.half_edge(b.half_edge(g).twin).facet);
      const double x0 = w.dot(n0), x1 = w.dot(n1), y0 = e.dot(m0), y1 = e.dot(m1);
      if (x0 * x1 >= 0 || y0 * y1 >= 0) continue;
      // The great circles meet in +-c; both arcs must pass through the same one.
      const Vec3 c = e.cross(w);
      const bool first = c.dot(n0 * std::abs(x1) + n1 * std::abs(x0)) > 0;
      const bool second = c.dot(m0 * std::abs(y1) + m1 * std::abs(y0)) > 0;
      count += first == second ? 1 : 0;
    }
  }
  return count;
}

TEST(Overlay, RandomSolidsHaveTheFacetsOfBruteForce) {
  std::mt19937_64 random(20261121);
  OverlayBuffers buffers;
  for (int round = 0; round < 300; ++round) {
    const ConvexPolytope a = hull(sphere_points(4 + round % 40, random));
    const ConvexPolytope b = hull(sphere_points(4 + (round * 7) % 60, random));
    const Pose pose_a = random_pose(random), pose_b = random_pose(random);
    const PosedPair pair(a, pose_a, b, pose_b);
    const std::vector<OverlayPiece> pieces = pieces_of(pair, buffers);
    const std::int64_t crossings = brute_force_crossings(a, pose_a, b, pose_b);
    ASSERT_EQ(static_cast<std::int64_t>(pieces.size()), a.num_facets() + b.num_facets() + crossings) << round;
    std::set<std::array<std::int32_t, 3>> distinct;
    for (const OverlayPiece& p : pieces) {
      std::int32_t x = p.a, y = p.b;
      if (p.kind == OverlayPiece::Kind::edges) {
        x = std::min(x, a.half_edge(x).twin);
        y = std::min(y, b.half_edge(y).twin);
      }
      EXPECT_TRUE(distinct.insert({static_cast<std::int32_t>(p.kind), x, y}).second);
    }
  }
}

TEST(Overlay, VerticesOfHighDegree) {
  // Pyramids and double pyramids: one or two cells with many sides, searched by halving.
  std::mt19937_64 random(17);
  std::uniform_real_distribution<double> uniform(0, 2 * M_PI);
  OverlayBuffers buffers;
  const auto pyramid = [&](int n, bool both) {
    std::vector<Vec3> points{{0.05, 0, 1}, {0, 0.03, both ? -1.2 : -0.3}};
    for (int i = 0; i < n; ++i) {
      const double t = uniform(random);
      points.push_back(Vec3(std::cos(t), std::sin(t), 0.01 * std::sin(3 * t)));
    }
    return hull(points);
  };
  for (int round = 0; round < 60; ++round) {
    const ConvexPolytope a = round % 3 == 0 ? hull(sphere_points(60, random)) : pyramid(20 + 2 * round, round % 2 == 0);
    const ConvexPolytope b = pyramid(90, round % 4 < 2);
    const Pose pose_a = random_pose(random), pose_b = random_pose(random);
    const PosedPair pair(a, pose_a, b, pose_b);
    ASSERT_EQ(static_cast<std::int64_t>(pieces_of(pair, buffers).size()),
              a.num_facets() + b.num_facets() + brute_force_crossings(a, pose_a, b, pose_b))
        << round;
  }
}

TEST(Overlay, EveryPlaneSupportsTheDifference) {
  std::mt19937_64 random(7);
  OverlayBuffers buffers;
  for (int round = 0; round < 20; ++round) {
    const ConvexPolytope a = hull(sphere_points(8 + round, random));
    const ConvexPolytope b = hull(sphere_points(20, random));
    const Pose pose_a = random_pose(random), pose_b = random_pose(random);
    const PosedPair pair(a, pose_a, b, pose_b);
    for (const OverlayPiece& piece : pieces_of(pair, buffers)) {
      const FacetOfDifference f = facet_of(pair, piece);
      for (int va = 0; va < a.num_vertices(); ++va) {
        for (int vb = 0; vb < b.num_vertices(); ++vb) {
          const PairVector x = PairVector::difference(f.a, f.b, va, vb);
          ASSERT_LE(pair.sign_determinant(x, f.u, f.v), 0);
        }
      }
    }
  }
}

// ---- integers: exact brute force over all candidate normals
// -----------------------------------------------------------

using Integer3 = std::array<std::int64_t, 3>;

Integer3 integer(const Vec3& v) { return {std::llround(v.x()), std::llround(v.y()), std::llround(v.z())}; }
Integer3 minus(const Integer3& a, const Integer3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Integer3 cross_product(const Integer3& a, const Integer3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
std::int64_t inner(const Integer3& a, const Integer3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Integer3 primitive(Integer3 n) {
  const std::int64_t g = std::gcd(std::gcd(n[0], n[1]), n[2]);
  if (g != 0) {
    for (std::int64_t& c : n) c /= g;
  }
  return n;
}

/// Normals of the facets of P, over the normals of all pairs of differences of vertices of one body or of both.
std::set<Integer3> brute_force_normals(const std::vector<Integer3>& a, const std::vector<Integer3>& b) {
  std::vector<Integer3> steps;
  for (const auto* body : {&a, &b}) {
    for (std::size_t i = 0; i < body->size(); ++i) {
      for (std::size_t j = i + 1; j < body->size(); ++j) steps.push_back(primitive(minus((*body)[j], (*body)[i])));
    }
  }
  std::sort(steps.begin(), steps.end());
  steps.erase(std::unique(steps.begin(), steps.end()), steps.end());
  std::set<Integer3> candidates;
  for (const Integer3& x : steps) {
    for (const Integer3& y : steps) candidates.insert(primitive(cross_product(x, y)));
  }
  candidates.erase({0, 0, 0});
  std::set<Integer3> normals;
  for (const Integer3& n : candidates) {
    std::vector<Integer3> points;
    for (const bool of_a : {true, false}) {
      const std::vector<Integer3>& body = of_a ? a : b;
      const std::int64_t sign = of_a ? -1 : 1;
      std::int64_t best = std::numeric_limits<std::int64_t>::min();
      for (const Integer3& v : body) best = std::max(best, sign * inner(v, n));
      std::vector<Integer3> face;
      for (const Integer3& v : body) {
        if (sign * inner(v, n) == best) face.push_back(v);
      }
      for (const Integer3& v : face) points.push_back(minus(v, face[0]));
    }
    Integer3 first{0, 0, 0};
    bool spans = false;
    for (const Integer3& p : points) {
      if (first == Integer3{0, 0, 0}) first = p;
      if (cross_product(first, p) != Integer3{0, 0, 0}) spans = true;
    }
    if (spans) normals.insert(n);
  }
  return normals;
}

std::vector<Integer3> integer_vertices(const ConvexPolytope& p) {
  std::vector<Integer3> result;
  for (int v = 0; v < p.num_vertices(); ++v) result.push_back(integer(p.vertex(v)));
  return result;
}

Integer3 integer_vector(const ConvexPolytope& a, const ConvexPolytope& b, const PairVector& v) {
  Integer3 r{0, 0, 0};
  const auto add = [&](const ConvexPolytope& p, int id, std::int64_t sign) {
    if (id < 0) return;
    const Integer3 x = integer(p.vertex(id));
    for (std::size_t i = 0; i < 3; ++i) r[i] += sign * x[i];
  };
  add(b, v.b_to, 1);
  add(b, v.b_from, -1);
  add(a, v.a_to, -1);
  add(a, v.a_from, 1);
  return r;
}

/// Facets after uniting coplanar pieces, checked: normals as brute force finds them, each once; every piece lies in one
/// of the planes; loops convex and Euler's formula for the polytope that they bound.
void check_integer_pair(const ConvexPolytope& a, const ConvexPolytope& b, OverlayBuffers& buffers) {
  const Pose identity;
  const PosedPair pair(a, identity, b, identity);
  const std::set<Integer3> expected = brute_force_normals(integer_vertices(a), integer_vertices(b));
  const bool flat = flat_difference(pair).has_value();
  ASSERT_EQ(flat, expected.size() <= 2);
  if (flat) return;
  const std::vector<OverlayPiece> pieces = pieces_of(pair, buffers);
  OverlayWalk walk(pair, buffers);
  std::vector<std::pair<OverlayPiece, FacePair>> whole;
  walk.run([&](std::span<const OverlayPiece> block) {
    for (const OverlayPiece& piece : block) {
      if (const auto faces = whole_facet(walk, piece)) whole.push_back({piece, *faces});
    }
    return true;
  });

  std::set<Integer3> planes;
  for (const OverlayPiece& piece : pieces) {
    const FacetOfDifference f = facet_of(pair, piece);
    const Integer3 n = cross_product(integer_vector(a, b, f.u), integer_vector(a, b, f.v));
    if (n != Integer3{0, 0, 0}) planes.insert(primitive(n));
  }
  EXPECT_EQ(planes, expected);

  std::set<Integer3> found;
  std::map<Integer3, std::array<std::int32_t, 2>> vertices;
  std::int64_t sides = 0;
  std::vector<DifferencePoint> loop;
  for (const auto& [piece, faces] : whole) {
    const FacetOfDifference f = facet_of(pair, piece);
    const Integer3 n = primitive(cross_product(integer_vector(a, b, f.u), integer_vector(a, b, f.v)));
    EXPECT_TRUE(found.insert(n).second);
    const InPlane plane(pair, f.u, f.v);
    sum_loop(pair, faces, plane, loop);
    ASSERT_GE(loop.size(), 3u);
    sides += static_cast<std::int64_t>(loop.size());
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const DifferencePoint p = loop[i], q = loop[(i + 1) % loop.size()], r = loop[(i + 2) % loop.size()];
      EXPECT_GT(plane.turn(PairVector::difference(p.a, p.b, q.a, q.b), PairVector::difference(q.a, q.b, r.a, r.b)), 0);
      const Integer3 x = integer_vector(a, b, PairVector::point(p.a, p.b));
      const auto [at, fresh] = vertices.insert({x, {p.a, p.b}});
      EXPECT_EQ(at->second, (std::array<std::int32_t, 2>{p.a, p.b}));
      EXPECT_EQ(inner(x, n), inner(integer_vector(a, b, f.point()), n));
    }
  }
  EXPECT_EQ(found, expected);
  const std::int64_t v = static_cast<std::int64_t>(vertices.size()), facets = static_cast<std::int64_t>(whole.size());
  EXPECT_EQ(sides % 2, 0);
  EXPECT_EQ(v - sides / 2 + facets, 2);
}

/// Small grid: nearly every pair has parallel edges, parallel facets, or edges in facets' planes.
ConvexPolytope grid_body(std::mt19937_64& random, int dimension) {
  std::uniform_int_distribution<int> coordinate(-2, 2);
  for (;;) {
    std::vector<Vec3> points;
    const int n = dimension + 1 + static_cast<int>(random() % 6);
    const int turned = static_cast<int>(random() % 3);
    for (int i = 0; i < n; ++i) {
      Vec3 p = Eigen::Vector3i{coordinate(random), coordinate(random), coordinate(random)}.cast<double>();
      for (int k = dimension; k < 3; ++k) p[(k + turned) % 3] = 1;
      points.push_back(p);
    }
    ConvexPolytope polytope = hull(points);
    if (polytope.affine_dimension() == dimension) return polytope;
  }
}

TEST(Overlay, GridBodiesOfEveryDimensionMatchExactBruteForce) {
  std::mt19937_64 random(99);
  OverlayBuffers buffers;
  for (int round = 0; round < 2000; ++round) {
    const ConvexPolytope a = grid_body(random, round % 4);
    const ConvexPolytope b = grid_body(random, (round / 4) % 4);
    SCOPED_TRACE(round);
    check_integer_pair(a, b, buffers);
    if (HasFailure()) return;
  }
}

TEST(Overlay, EqualBodiesAndPrisms) {
  std::mt19937_64 random(5);
  OverlayBuffers buffers;
  for (int round = 0; round < 100; ++round) {
    const ConvexPolytope a = grid_body(random, 3);
    check_integer_pair(a, a, buffers);
    std::vector<Vec3> prism;
    const ConvexPolytope base = grid_body(random, 2);
    for (int v = 0; v < base.num_vertices(); ++v) {
      prism.push_back(base.vertex(v));
      prism.push_back(base.vertex(v) + Vec3(1, 2, 3));
    }
    const ConvexPolytope b = hull(prism);
    check_integer_pair(a, b, buffers);
    check_integer_pair(b, b, buffers);
    if (HasFailure()) return;
  }
}

/// Doubly covered polygons in one plane, however they face: the loop runs once round their difference, to the left.
TEST(FlatDifference, LoopHasAllDifferencesOnItsLeft) {
  std::mt19937_64 random(9);
  std::uniform_int_distribution<int> coordinate(-3, 3);
  const auto polygon = [&] {
    std::vector<Vec3> points;
    for (int i = 0; i < 5; ++i) {
      const int x = coordinate(random);
      points.emplace_back(x, coordinate(random), 0);
    }
    return hull(points);
  };
  const Pose over = *Pose::from_quaternion({0, 1, 0, 0}, Vec3::Zero());  // half a turn about x
  int judged = 0;
  for (int i = 0; i < 200; ++i) {
    const ConvexPolytope a = polygon(), b = polygon();
    if (a.affine_dimension() != 2 || b.affine_dimension() != 2) continue;
    for (const Pose& pose_a : {Pose(), over}) {
      for (const Pose& pose_b : {Pose(), over}) {
        const PosedPair pair(a, pose_a, b, pose_b);
        const auto flat = flat_difference(pair);
        ASSERT_TRUE(flat);
        ASSERT_EQ(flat->affine_dimension, 2);
        const InPlane plane(pair, flat->u, flat->v);
        std::vector<DifferencePoint> loop;
        sum_loop(pair, flat->faces, plane, loop);
        ASSERT_GE(loop.size(), 3u);
        for (std::size_t k = 0; k < loop.size(); ++k) {
          const DifferencePoint from = loop[k], to = loop[(k + 1) % loop.size()];
          const PairVector side = PairVector::difference(from.a, from.b, to.a, to.b);
          for (int va = 0; va < a.num_vertices(); ++va) {
            for (int vb = 0; vb < b.num_vertices(); ++vb) {
              EXPECT_GE(plane.turn(side, PairVector::difference(from.a, from.b, va, vb)), 0);
            }
          }
        }
        ++judged;
      }
    }
  }
  EXPECT_GT(judged, 400);
}

TEST(Overlay, AlignedBoxesHaveSixFacets) {
  const ConvexPolytope a = *ConvexPolytope::box(Vec3(1, 2, 3));
  const ConvexPolytope b = *ConvexPolytope::box(Vec3(2, 2, 1));
  OverlayBuffers buffers;
  const Pose identity;
  const PosedPair pair(a, identity, b, identity);
  OverlayWalk walk(pair, buffers);
  int count = 0;
  walk.run([&](std::span<const OverlayPiece> block) {
    for (const OverlayPiece& piece : block) {
      const auto faces = whole_facet(walk, piece);
      if (!faces) continue;
      ++count;
      EXPECT_EQ(faces->on_a.kind, Feature::Kind::facet);
      EXPECT_EQ(faces->on_b.kind, Feature::Kind::facet);
    }
    return true;
  });
  EXPECT_EQ(count, 6);
}

}  // namespace
}  // namespace pd::detail
