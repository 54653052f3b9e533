// Widths, bodies of halfspaces and changes of representation, against scans of known vertices.

#include "pd/dimension/approximate_body.hpp"

#include <gtest/gtest.h>

#include "dimension/body_families.hpp"
#include "dimension/families.hpp"
#include "pd/dimension/approximate_width.hpp"

namespace pd::dimension {
namespace {

using namespace test;

/// A body known both ways: an affine image of a cube (even) or a simplex (odd), with redundant halfspaces.
template <int D>
struct Known {
  std::vector<Vector<D>> vertices;
  std::vector<Halfspace<D>> halfspaces;
};

template <int D>
Known<D> known_body(int kind, double aspect, Random& random) {
  Known<D> r;
  if (kind % 2 == 0) {
    r.vertices = family_points<D>(2, 0, random);
    for (int k = 0; k < D; ++k) {
      r.halfspaces.push_back({Vector<D>::Unit(k), 1});
      r.halfspaces.push_back({-Vector<D>::Unit(k), 1});
    }
  } else {
    r.vertices.push_back(Vector<D>::Zero());
    for (int k = 0; k < D; ++k) {
      r.vertices.push_back(Vector<D>::Unit(k));
      r.halfspaces.push_back({-Vector<D>::Unit(k), 0});
    }
    r.halfspaces.push_back({Vector<D>::Ones(), 1});
  }
  for (int i = 0; i < 20; ++i) {
    const Vector<D> v = random_direction<D>(random);
    r.halfspaces.push_back({v, scanned_support<D>(r.vertices, v) * (1 + 0.2 * (i % 3)) + 1e-3});
  }
  const AffineMap<D> map{random_stretch<D>(random, aspect), 3 * random_direction<D>(random)};
  for (Vector<D>& p : r.vertices) p = map.apply(p);
  const Matrix<D> inverse = inverse_of<D>(map.linear);
  for (Halfspace<D>& h : r.halfspaces) {
    h.normal = inverse.transpose() * h.normal;
    h.offset += h.normal.dot(map.translation);
  }
  return r;
}

template <int D>
void check_halfspace_bodies() {
  Random random(3 + D);
  for (int kind = 0; kind < 4; ++kind) {
    for (const double aspect : {1.0, 1e6, 1e-6}) {
      SCOPED_TRACE("d = " + std::to_string(D) + ", kind " + std::to_string(kind) + ", aspect " +
                   std::to_string(aspect));
      const Known<D> known = known_body<D>(kind, aspect, random);
      const auto body = Body<D>::from_halfspaces(known.halfspaces);
      ASSERT_TRUE(body) << body.error().message;
      EXPECT_LE(body->sandwich().ratio, 1.6 * D);
      const auto kernel = DirectionalWidth<D>::build(*body, 0.1, Backend::kernel);
      ASSERT_TRUE(kernel);
      QueryCounters counters;
      for (const Vector<D>& v : hard_directions<D>(*body, 20, random)) {
        const double width = scanned_extent<D>(known.vertices, v), support = scanned_support<D>(known.vertices, v);
        // Vertices and planes are rounded images; the tilt of a plane of a needle moves its tip.
        const double room = 1e-7 * width;
        EXPECT_NEAR(body->support(v).value, support, room);
        EXPECT_GE(kernel->width(v, counters).width * v.norm(), 0.9 * width - room);
        EXPECT_LE(kernel->support(v, counters).value, support + room);
      }
    }
  }
}

TEST(HalfspaceBody, HasTheSupportsOfItsVertices) {
  check_halfspace_bodies<2>();
  check_halfspace_bodies<3>();
  check_halfspace_bodies<4>();
  check_halfspace_bodies<5>();
}

/// Polar points of bodies of few vertices lie by the hundred on common faces: the surface over them must stay convex.
template <int D>
void check_bodies_of_approximations(double epsilon) {
  BodySource<D> source(53);
  for (int k = 0; k < 16; ++k) {
    const auto points = source.points(k % 2 == 0 ? Family::needle : Family::slab, 44 + k);
    const auto body = Body<D>::from_points(points);
    ASSERT_TRUE(body);
    const auto made = approximate_body<D>(*body, epsilon, Representation::halfspaces, Side::outer);
    ASSERT_TRUE(made);
    const auto polytope = Body<D>::from_halfspaces(made->halfspaces);
    ASSERT_TRUE(polytope) << polytope.error().message;
    for (int turn = 0; turn < 6; ++turn) {
      Vector<D> v = source.direction();
      if (turn % 2 == 1) v = (body->sandwich().fattening().linear.transpose() * v).normalized();
      const double h = extreme<D>(points, v).dot(v), width = extent<D>(points, v);
      EXPECT_GE(polytope->support(v).value, h - 1e-7 * width) << "D = " << D << ", body " << k;
      EXPECT_LE(polytope->support(v).value, h + (epsilon / 2 + 1e-7) * width) << "D = " << D << ", body " << k;
    }
  }
}

TEST(HalfspaceBody, OfApproximationsWhoseFacesAreSharedByMany) {
  check_bodies_of_approximations<3>(0.1);
  check_bodies_of_approximations<4>(0.4);
  check_bodies_of_approximations<5>(0.6);
}

TEST(HalfspaceBody, RefusesByName) {
  using H = Halfspace<2>;
  using V = Vector<2>;
  const auto code = [](std::vector<H> h) { return Body<2>::from_halfspaces(std::move(h)).error().code; };
  EXPECT_EQ(code({H{V(1, 0), 1}, H{V(-1, 0), 1}, H{V(0, 1), 1}}), ErrorCode::unbounded);
  EXPECT_EQ(code({H{V(1, 0), 0}, H{V(0, 1), 0}, H{V(1, 1), 0}}), ErrorCode::unbounded);
  EXPECT_EQ(code({H{V(1, 0), 1}, H{V(-1, 0), -2}, H{V(0, 1), 1}, H{V(0, -1), 1}}), ErrorCode::bad_value);
  EXPECT_EQ(code({H{V(1, 0), 1}, H{V(-1, 0), -1}, H{V(0, 1), 1}, H{V(0, -1), 1}}), ErrorCode::not_full_dimensional);
  EXPECT_EQ(code({H{V(1, 0), 1}, H{V(0, 0), 1}, H{V(0, 1), 1}, H{V(0, -1), 1}}), ErrorCode::zero_direction);
  EXPECT_EQ(code({H{V(1, 0), INFINITY}, H{V(-1, 0), 1}, H{V(0, 1), 1}}), ErrorCode::non_finite);
  EXPECT_EQ(code({H{V(1, 0), 1}, H{V(-1, 0), 1}}), ErrorCode::too_few_points);
}

TEST(Body, RefusesSingularMaps) {
  Random random(1);
  const auto body = Body<3>::from_points(family_points<3>(0, 50, random));
  AffineMap<3> map;
  map.linear.row(2) = map.linear.row(1);
  EXPECT_EQ(body->transformed(map).error().code, ErrorCode::bad_value);
  map.linear(0, 0) = NAN;
  EXPECT_EQ(body->transformed(map).error().code, ErrorCode::non_finite);
}

/// Supports of an approximation, by its own kind of scan.
template <int D>
double support_of(const ApproximateBody<D>& a, const Vector<D>& v) {
  if (a.representation == Representation::points) return scanned_support<D>(a.points, v);
  return Body<D>::from_halfspaces(a.halfspaces)->support(v).value;
}

template <int D>
void check_approximation(const Body<D>& body, std::span<const Vector<D>> vertices, double epsilon, double rounding,
                         Random& random) {
  for (const Representation wanted : {Representation::points, Representation::halfspaces}) {
    for (const Side side : {Side::inner, Side::outer}) {
      const auto a = approximate_body<D>(body, epsilon, wanted, side);
      ASSERT_TRUE(a) << a.error().message;
      for (const Vector<D>& v : hard_directions<D>(body, 6, random)) {
        const double width = scanned_extent<D>(vertices, v), support = scanned_support<D>(vertices, v);
        const double room = rounding * width;
        const double high = support_of<D>(*a, v), low = -support_of<D>(*a, -v);
        if (side == Side::outer) {
          ASSERT_GE(high, support - room);
          ASSERT_LE(high, support + epsilon / 2 * width + room);
        } else {
          ASSERT_LE(high, support + room);
          ASSERT_GE(high - low, (1 - epsilon) * width - room);
        }
      }
    }
  }
}

template <int D>
void check_approximations(double epsilon) {
  Random random(61 + D);
  for (int family = 0; family < kFamilies; ++family) {
    SCOPED_TRACE(family_name(family) + ", d = " + std::to_string(D));
    const auto body = Body<D>::from_points(family_points<D>(family, 100, random));
    ASSERT_TRUE(body);
    check_approximation<D>(*body, body->points(), epsilon, 1e-7, random);
  }
  for (int kind = 0; kind < 2; ++kind) {
    const Known<D> known = known_body<D>(kind, 1e3, random);
    const auto body = Body<D>::from_halfspaces(known.halfspaces);
    ASSERT_TRUE(body);
    check_approximation<D>(*body, known.vertices, epsilon, 1e-7, random);
  }
}

TEST(ApproximateBody, KeepsItsSideAndItsEpsilon) {
  check_approximations<2>(0.01);
  check_approximations<3>(0.05);
  check_approximations<4>(0.3);
}

/// By hyperplanes through D points: the width of a polytope is met by a pair of faces; all pairs are too many, so the
/// oracle here is a descent from many directions, an upper bound, beside the certificate's own lower bound.
template <int D>
double sampled_width(std::span<const Vector<D>> points, const Matrix<D>& fat, Random& random) {
  double least = INFINITY;
  for (int i = 0; i < 30; ++i) {
    Vector<D> v = (fat.transpose() * random_direction<D>(random)).normalized();
    double width = scanned_extent<D>(points, v);
    for (double step = 0.5; step > 1e-6; step *= 0.7) {
      for (int k = 0; k < 12; ++k) {
        const Vector<D> w = (v + step * v.norm() * random_direction<D>(random)).normalized();
        const double other = scanned_extent<D>(points, w);
        if (other < width) {
          width = other;
          v = w;
        }
      }
    }
    least = std::min(least, width);
  }
  return least;
}

template <int D>
void check_width(std::initializer_list<double> epsilons) {
  Random random(71 + D);
  for (int family = 0; family < kFamilies; ++family) {
    for (const double epsilon : epsilons) {
      SCOPED_TRACE(family_name(family) + ", d = " + std::to_string(D) + ", epsilon = " + std::to_string(epsilon));
      const auto body = Body<D>::from_points(family_points<D>(family, 60, random));
      for (const Backend backend : {Backend::kernel, Backend::exact}) {
        const auto width = approximate_width<D>(*body, epsilon, backend);
        ASSERT_TRUE(width) << width.error().message;
        EXPECT_LE(width->lower, width->upper);
        EXPECT_LE(width->upper, (1 + epsilon) * width->lower);
        EXPECT_NEAR(width->direction.norm(), 1, 1e-14);
        EXPECT_NEAR(scanned_extent<D>(body->points(), width->direction), width->upper, 1e-9 * width->upper + 1e-15);
        // No direction is thinner than the lower bound.
        EXPECT_GE(sampled_width<D>(body->points(), body->sandwich().fattening().linear, random),
                  width->lower * (1 - 1e-9));
      }
    }
  }
}

TEST(ApproximateWidth, BracketsTheWidth) {
  check_width<2>({0.9, 1e-2, 1e-5});
  check_width<3>({0.3, 1e-3});
  check_width<4>({0.3, 3e-2});
  check_width<5>({0.5});
}

template <int D>
void check_width_over_macbeath(double epsilon, int count) {
  BodySource<D> source(5);
  for (const Family family : {Family::sphere, Family::needle}) {
    const auto points = source.points(family, count);
    const auto body = Body<D>::from_points(points);
    const auto width = approximate_width<D>(*body, epsilon, Backend::macbeath);
    ASSERT_TRUE(width) << width.error().message;
    EXPECT_LE(width->upper, (1 + epsilon) * width->lower);
    EXPECT_NEAR(extent<D>(points, width->direction), width->upper, 1e-9 * width->upper + 1e-15);
    for (int turn = 0; turn < 50; ++turn) {
      const Vector<D> v = (body->sandwich().fattening().linear.transpose() * source.direction()).normalized();
      EXPECT_GE(extent<D>(points, v), width->lower * (1 - 1e-9)) << "D = " << D;
    }
  }
}

TEST(ApproximateWidth, OverMacbeathHierarchies) {
  check_width_over_macbeath<2>(0.01, 60);
  check_width_over_macbeath<3>(0.5, 40);
  check_width_over_macbeath<4>(0.95, 30);
  check_width_over_macbeath<4>(0.5, 30);
}

TEST(ApproximateWidth, OfAnalyticBodies) {
  Random random(1);
  // Cube of edge 2: width 2. Regular simplex on unit vectors' hull with the origin, d = 3: the face x + y + z = 1 is at
  // distance 1 / sqrt(3) from the origin, and no direction is thinner.
  EXPECT_NEAR(approximate_width<4>(*Body<4>::from_points(family_points<4>(2, 0, random)), 1e-3)->width, 2, 2e-3);
  EXPECT_NEAR(approximate_width<3>(*Body<3>::from_points(family_points<3>(3, 0, random)), 1e-4)->width,
              1 / std::sqrt(3.0), 1e-4);
  const Known<3> slab = known_body<3>(0, 1e-3, random);
  EXPECT_NEAR(approximate_width<3>(*Body<3>::from_halfspaces(slab.halfspaces), 1e-2)->width, 2e-3, 2.1e-5);
}

}  // namespace
}  // namespace pd::dimension
