#include "pd/dimension/approximate_intersection.hpp"

#include <gtest/gtest.h>

#include <array>
#include <limits>

#include "dimension/body_families.hpp"

namespace pd::dimension::test {
namespace {

/// A body of known points and its structures.
template <int D>
struct Prepared {
  std::vector<Vector<D>> points;
  DirectionalWidth<D> structure;
};

template <int D>
DirectionalWidth<D> prepare(const std::vector<Vector<D>>& points, double epsilon, Backend backend) {
  const auto body = Body<D>::from_points(points);
  EXPECT_TRUE(body) << (body ? "" : body.error().message);
  auto structure = DirectionalWidth<D>::build(*body, epsilon, backend);
  EXPECT_TRUE(structure) << (structure ? "" : structure.error().message);
  return *structure;
}

template <int D>
std::vector<Prepared<D>> prepare_families(BodySource<D>& source, int each, double epsilon, Backend backend) {
  std::vector<Prepared<D>> r;
  for (const Family family : kBodyFamilies) {
    for (int k = 0; k < each; ++k) {
      std::vector<Vector<D>> points = source.points(family, 20 + 15 * D);
      DirectionalWidth<D> structure = prepare<D>(points, epsilon, backend);
      r.push_back({std::move(points), std::move(structure)});
    }
  }
  return r;
}

template <int D>
AffineMap<D> random_map(BodySource<D>& source) {
  AffineMap<D> map;
  map.linear = source.rotation();
  for (int i = 0; i < D; ++i) map.linear.col(i) *= source.uniform(0.3, 2);
  for (int i = 0; i < D; ++i) map.translation[i] = source.uniform(-3, 3);
  return map;
}

/// Moves B so that the truth is known by construction: a common point a little inside both, or a slab across some
/// direction that is just wider than what growing by epsilon fills. Neither needs a solver.
template <int D>
void check_pairs(Backend backend, double epsilon, int bodies, int cases, IntersectionSearch search, double prepared) {
  SCOPED_TRACE(testing::Message() << "D = " << D << ", epsilon = " << epsilon << ", backend " << int(backend));
  BodySource<D> source(7);
  const auto pool = prepare_families<D>(source, bodies, prepared, backend);
  std::int64_t most = 0;
  for (int k = 0; k < cases; ++k) {
    const auto pick = [&] { return static_cast<std::size_t>(source.uniform(0, 0.999999 * double(pool.size()))); };
    const Prepared<D>& a = pool[pick()];
    const Prepared<D>& b = pool[pick()];
    const AffineMap<D> place_a = random_map<D>(source);
    AffineMap<D> place_b = random_map<D>(source);
    const auto points_a = image<D>(a.points, place_a);
    const auto points_b = image<D>(b.points, place_b);
    const Vector<D> v = source.direction();
    const Vector<D> tip_a = extreme<D>(points_a, v);
    const Vector<D> tip_b = extreme<D>(points_b, -v);
    const bool meets = k % 2 == 0;
    if (meets) {
      // A point of each, nearly its tip, laid upon the other.
      const double inwards = std::pow(10.0, source.uniform(-9, 0));
      Vector<D> mean_a = Vector<D>::Zero(), mean_b = Vector<D>::Zero();
      for (const auto& p : points_a) mean_a += p / double(points_a.size());
      for (const auto& p : points_b) mean_b += p / double(points_b.size());
      place_b.translation += tip_a + inwards * (mean_a - tip_a) - (tip_b + inwards * (mean_b - tip_b));
    } else {
      const double gap = 0.5 * epsilon * (extent<D>(points_a, v) + extent<D>(points_b, v)) * (1 + 1e-4) + 1e-13;
      place_b.translation += tip_a + gap * v - tip_b;
    }
    const std::array<ComposedBody<D>, 2> pair = {*ComposedBody<D>::of(a.structure, place_a),
                                                 *ComposedBody<D>::of(b.structure, place_b)};
    const auto answer = approximate_intersection<D>(pair, epsilon, search);
    ASSERT_TRUE(answer) << answer.error().message;
    EXPECT_EQ(answer->intersect, meets) << "case " << k;
    most = std::max(most, answer->support_calls);
  }
  if (search == IntersectionSearch::cutting_planes) {
    EXPECT_LE(most, 60 + 60 * D);  // the proved number is O(D^2 log(1 / epsilon))
  }
}

TEST(ApproximateIntersection, KeepsItsPromiseInEveryDimension) {
  constexpr auto kSearch = IntersectionSearch::cutting_planes;
  for (const double epsilon : {0.3, 1e-2, 1e-4}) {
    check_pairs<2>(Backend::kernel, epsilon, 3, 1000, kSearch, epsilon / 4);
    check_pairs<3>(Backend::kernel, epsilon, 2, 600, kSearch, epsilon / 4);
    check_pairs<4>(Backend::kernel, epsilon, 1, 200, kSearch, epsilon / 4);
    check_pairs<5>(Backend::kernel, epsilon, 1, 60, kSearch, epsilon / 4);
  }
}

TEST(ApproximateIntersection, KeepsItsPromiseOverExactStructures) {
  constexpr auto kSearch = IntersectionSearch::cutting_planes;
  check_pairs<2>(Backend::exact, 1e-3, 3, 1000, kSearch, 0.5);
  check_pairs<3>(Backend::exact, 1e-3, 2, 500, kSearch, 0.5);
  check_pairs<4>(Backend::exact, 1e-3, 1, 200, kSearch, 0.5);
  check_pairs<5>(Backend::exact, 1e-3, 1, 60, kSearch, 0.5);
}

TEST(ApproximateIntersection, KeepsItsPromiseOverMacbeathHierarchies) {
  constexpr auto kSearch = IntersectionSearch::cutting_planes;
  check_pairs<2>(Backend::macbeath, 1e-2, 1, 500, kSearch, 0.25e-2);
  check_pairs<3>(Backend::macbeath, 0.3, 1, 200, kSearch, 0.075);
  check_pairs<4>(Backend::macbeath, 0.95, 1, 30, kSearch, 0.2375);
}

TEST(ApproximateIntersection, NestedTernaryAgrees) {
  constexpr auto kSearch = IntersectionSearch::nested_ternary;
  check_pairs<2>(Backend::kernel, 1e-3, 2, 400, kSearch, 1e-3 / 4);
  check_pairs<3>(Backend::kernel, 0.05, 1, 40, kSearch, 0.05 / 4);
}

template <int D>
ComposedBody<D> box(const Vector<D>& low, const Vector<D>& high, Backend backend = Backend::exact) {
  std::vector<Vector<D>> points;
  for (int k = 0; k < (1 << D); ++k) {
    Vector<D> p;
    for (int i = 0; i < D; ++i) p[i] = ((k >> i) & 1) != 0 ? high[i] : low[i];
    points.push_back(p);
  }
  return *ComposedBody<D>::of(prepare<D>(points, 1e-3, backend));
}

TEST(ApproximateIntersection, ThreeBodiesMayMeetInPairsOnly) {
  // Three strips about a triangular hole.
  const auto strip = [](double angle, double offset) {
    AffineMap<2> map;
    map.linear << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
    map.translation = map.linear * Vector<2>(0, offset);
    const auto structure = prepare<2>({{-5, 0}, {5, 0}, {5, 0.1}, {-5, 0.1}}, 1e-3, Backend::exact);
    return *ComposedBody<2>::of(structure, map);
  };
  const double third = 2.0943951023931953;
  for (const auto& [offset, meets] : {std::pair(0.3, false), std::pair(-0.05, true), std::pair(0.05, false)}) {
    const std::array<ComposedBody<2>, 3> strips = {strip(0, offset), strip(third, offset), strip(2 * third, offset)};
    for (int i = 0; i < 3; ++i) {
      const std::array<ComposedBody<2>, 2> two = {strips[std::size_t(i)], strips[std::size_t((i + 1) % 3)]};
      EXPECT_TRUE(approximate_intersection<2>(two, 0.1)->intersect);
    }
    EXPECT_EQ(approximate_intersection<2>(strips, 0.1)->intersect, meets) << offset;
    // The same as an intersection that meets a third body.
    const std::array<ComposedBody<2>, 2> nested = {*ComposedBody<2>::intersection_of({strips[0], strips[1]}),
                                                   strips[2]};
    EXPECT_EQ(approximate_intersection<2>(nested, 0.1)->intersect, meets) << offset;
  }
}

TEST(ApproximateIntersection, SumsAndHullsMeetWithoutBeingBuilt) {
  using Body3 = ComposedBody<3>;
  const Body3 cube = box<3>({-1, -1, -1}, {1, 1, 1});
  const Body3 bar = box<3>({-0.1, -0.1, -3}, {0.1, 0.1, 3});
  const Body3 sum = *Body3::sum_of({cube, bar});  // reaches z = 4
  const auto meets = [&](const Body3& a, const Body3& b) {
    const std::array<Body3, 2> pair = {a, b};
    return approximate_intersection<3>(pair, 1e-3)->intersect;
  };
  EXPECT_TRUE(meets(sum, box<3>({-1, -1, 3.99}, {1, 1, 5})));
  EXPECT_FALSE(meets(sum, box<3>({-1, -1, 4.01}, {1, 1, 5})));
  EXPECT_FALSE(meets(cube, box<3>({-1, -1, 3.99}, {1, 1, 5})));
  // The hull of two far cubes holds the middle between them.
  const Body3 hull = *Body3::hull_of({box<3>({-9, -1, -1}, {-7, 1, 1}), box<3>({7, -1, -1}, {9, 1, 1})});
  EXPECT_TRUE(meets(hull, box<3>({-0.1, 0.99, -0.1}, {0.1, 2, 0.1})));
  EXPECT_FALSE(meets(hull, box<3>({-0.1, 1.02, -0.1}, {0.1, 2, 0.1})));
  // Sums of intersections: [0, 1]^3 from two larger boxes, plus the bar.
  const Body3 corner = *Body3::intersection_of({box<3>({-1, -1, -1}, {1, 1, 1}), box<3>({0, 0, 0}, {2, 2, 2})});
  const Body3 long_corner = *Body3::sum_of({corner, bar});
  EXPECT_TRUE(meets(long_corner, box<3>({0.2, 0.2, 3.98}, {1, 1, 5})));
  EXPECT_FALSE(meets(long_corner, box<3>({0.2, 0.2, 4.05}, {1, 1, 5})));
  EXPECT_FALSE(meets(long_corner, box<3>({-0.5, -0.5, 0}, {-0.15, 1, 1})));
}

TEST(ApproximateMembership, OfASum) {
  const auto sum =
      *ComposedBody<4>::sum_of({box<4>({-1, -1, -1, -1}, {1, 1, 1, 1}), box<4>({-2, -2, -2, -2}, {0, 0, 0, 0})});
  EXPECT_TRUE(approximate_membership<4>(sum, {1, 1, 1, 1}, 1e-2)->intersect);
  EXPECT_TRUE(approximate_membership<4>(sum, {-3, -3, -3, 1}, 1e-2)->intersect);
  EXPECT_FALSE(approximate_membership<4>(sum, {1.03, 0, 0, 0}, 1e-2)->intersect);
  EXPECT_FALSE(approximate_membership<4>(sum, {-3, -3, -3, -3.03}, 1e-2)->intersect);
}

TEST(ApproximateIntersection, RefusesByName) {
  const std::array<ComposedBody<2>, 2> coarse = {box<2>({0, 0}, {1, 1}, Backend::kernel),
                                                 box<2>({0, 0}, {1, 1}, Backend::kernel)};
  for (const double epsilon : {0.0, 1.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    const auto refused = approximate_intersection<2>(coarse, epsilon);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::bad_value);
    EXPECT_EQ(refused.error().where, "epsilon");
  }
  EXPECT_EQ(approximate_intersection<2>(coarse, 1e-3).error().code, ErrorCode::bad_value);  // preprocessed at 1e-3
  EXPECT_NE(approximate_intersection<2>(coarse, 4e-8)
                .error()
                .message.find("0.001; this query needs a quarter of its own "
                              "epsilon, 1e-08"),
            std::string::npos)
      << approximate_intersection<2>(coarse, 4e-8).error().message;
  EXPECT_TRUE(approximate_intersection<2>(coarse, 4e-3));
  EXPECT_EQ(ComposedBody<2>::sum_of({}).error().code, ErrorCode::bad_value);
  AffineMap<2> flat;
  flat.linear << 1, 2, 2, 4;
  EXPECT_EQ(ComposedBody<2>::of(prepare<2>({{0, 0}, {1, 0}, {0, 1}}, 0.1, Backend::exact), flat).error().code,
            ErrorCode::bad_value);
  const std::vector<ComposedBody<2>> many(22, coarse[0]);
  EXPECT_EQ(approximate_intersection<2>(many, 0.1).error().code, ErrorCode::limit_exceeded);
}

}  // namespace
}  // namespace pd::dimension::test
