#include "pd/dimension/approximate_minkowski_sum.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>

#include "dimension/body_families.hpp"
#include "dimension/composed/growing_sum.hpp"

namespace pd::dimension::test {
namespace {

template <int D>
ComposedBody<D> prepare(const std::vector<Vector<D>>& points, double epsilon, Backend backend) {
  const auto body = Body<D>::from_points(points);
  EXPECT_TRUE(body) << (body ? "" : body.error().message);
  const auto structure = DirectionalWidth<D>::build(*body, epsilon, backend);
  EXPECT_TRUE(structure) << (structure ? "" : structure.error().message);
  return *ComposedBody<D>::of(*structure);
}

/// The largest <v, x> over the body that was made, asked many times.
template <int D>
class Reach {
 public:
  explicit Reach(const ApproximateBody<D>& body) : body_(body) {
    if (body.representation == Representation::points) return;
    const auto polytope = Body<D>::from_halfspaces(body.halfspaces);
    EXPECT_TRUE(polytope) << (polytope ? "" : polytope.error().message);
    if (polytope) polytope_ = *polytope;
  }
  [[nodiscard]] double operator()(const Vector<D>& v) const {
    if (body_.representation == Representation::points) return extreme<D>(body_.points, v).dot(v);
    return polytope_ ? polytope_->support(v).value : 0;
  }

 private:
  const ApproximateBody<D>& body_;
  std::optional<Body<D>> polytope_;
};

/// Every promise, against supports of the sum by brute force: random directions, and those of the input's differences.
template <int D>
void check_sums(Backend backend, double epsilon, int count, int cases) {
  BodySource<D> source(11);
  for (int k = 0; k < cases; ++k) {
    std::vector<std::vector<Vector<D>>> parts;
    std::vector<ComposedBody<D>> bodies;
    for (int i = 0; i < 2 + k % 2; ++i) {
      const Family family = kBodyFamilies[std::size_t(source.uniform(0, 5.999))];
      parts.push_back(source.points(family, count));
      bodies.push_back(prepare<D>(parts.back(), epsilon / 4, backend));
    }
    const ComposedBody<D> sum = *ComposedBody<D>::sum_of(bodies);
    for (const auto representation : {Representation::points, Representation::halfspaces}) {
      for (const Side side : {Side::inner, Side::outer}) {
        SCOPED_TRACE(testing::Message() << "D = " << D << ", case " << k
                                        << (side == Side::inner ? ", inner " : ", outer ")
                                        << (representation == Representation::points ? "points" : "halfspaces"));
        const auto made = approximate_minkowski_sum<D>(sum, epsilon, representation, side);
        ASSERT_TRUE(made) << made.error().message;
        const Reach<D> reach(made->body);
        for (int turn = 0; turn < 12; ++turn) {
          Vector<D> v = source.direction();
          if (turn % 3 == 0) v = (parts[0][0] - parts[1][std::size_t(turn) % parts[1].size()]).normalized();
          double h = 0, width = 0;
          for (const auto& points : parts) {
            h += extreme<D>(points, v).dot(v);
            width += extent<D>(points, v);
          }
          const double high = reach(v);
          const double room = 1e-7 * width + 1e-14;
          if (side == Side::outer) {
            EXPECT_GE(high, h - room);
            EXPECT_LE(high, h + epsilon / 2 * width + room);
          } else {
            EXPECT_LE(high, h + room);
            EXPECT_GE(high + reach(-v), (1 - epsilon) * width - room);
          }
        }
      }
    }
  }
}

TEST(ApproximateMinkowskiSum, KeepsItsPromises) {
  check_sums<2>(Backend::kernel, 1e-3, 60, 30);
  check_sums<2>(Backend::exact, 0.1, 60, 30);
  check_sums<3>(Backend::kernel, 0.05, 60, 12);
  check_sums<4>(Backend::kernel, 0.3, 40, 4);
  check_sums<5>(Backend::kernel, 0.7, 20, 2);
}

TEST(ApproximateMinkowskiSum, OverMacbeathHierarchies) {
  check_sums<2>(Backend::macbeath, 0.05, 40, 6);
  check_sums<3>(Backend::macbeath, 0.6, 30, 2);
  check_sums<4>(Backend::macbeath, 0.95, 30, 1);
}

TEST(ApproximateMinkowskiSum, CubesAddUpToACube) {
  BodySource<3> source(3);
  std::vector<Vector<3>> cube;
  for (int k = 0; k < 8; ++k) cube.push_back({k & 1 ? 1.0 : -1.0, k & 2 ? 1.0 : -1.0, k & 4 ? 1.0 : -1.0});
  const ComposedBody<3> body = prepare<3>(cube, 1e-3, Backend::exact);
  const auto sum =
      approximate_minkowski_sum<3>(*ComposedBody<3>::sum_of({body, body}), 1e-2, Representation::halfspaces);
  ASSERT_TRUE(sum);
  EXPECT_EQ(sum->facets, 6);
  for (const Halfspace<3>& h : sum->body.halfspaces) EXPECT_NEAR(h.offset, 2, 1e-6);
  const auto corners =
      approximate_minkowski_sum<3>(*ComposedBody<3>::sum_of({body, body}), 1e-2, Representation::points, Side::inner);
  EXPECT_EQ(corners->body.points.size(), 8u);
}

/// O(1 / epsilon^((d - 1) / 2)): each tenth of epsilon costs at most 10^((d - 1) / 2) times the points, and some.
template <int D>
void check_size(double coarse, double fine, int count) {
  BodySource<D> source(5);
  const auto size = [&](double epsilon) {
    const auto a = prepare<D>(source.points(Family::sphere, count), epsilon / 4, Backend::kernel);
    const auto b = prepare<D>(source.points(Family::sphere, count), epsilon / 4, Backend::kernel);
    return double(
        approximate_minkowski_sum<D>(*ComposedBody<D>::sum_of({a, b}), epsilon, Representation::points)->vertices);
  };
  const double slope = std::log(size(fine) / size(coarse)) / std::log(coarse / fine);
  EXPECT_NEAR(slope, 0.5 * (D - 1), 0.2) << "D = " << D;
}

TEST(ApproximateMinkowskiSum, SizeGrowsAsTheoremTwoSays) {
  check_size<2>(1e-2, 1e-4, 20000);
  check_size<3>(0.1, 1e-2, 20000);
}

/// Where a growth ends by its budget, what it certifies holds all the same.
template <int D>
void check_growth_by_budget(std::int64_t most_work) {
  BodySource<D> source(3);
  const ComposedBody<D> first = prepare<D>(source.points(Family::sphere, 200), 1e-4, Backend::kernel);
  const ComposedBody<D> second = prepare<D>(source.points(Family::sphere, 200), 1e-4, Backend::kernel);
  const ComposedBody<D> sum = *ComposedBody<D>::sum_of({first, second});
  detail::GrowingSum grown(sum.node());
  ASSERT_EQ(grown.grow(1 + 1e-3, most_work), detail::Growth::spent) << "D = " << D;
  EXPECT_GT(grown.reached(), 1 + 1e-3);
  EXPECT_LT(grown.reached(), 2) << "D = " << D;
  for (int k = 0; k < 200; ++k) {
    const Vector<D> v = source.direction();
    QueryCounters counters;
    const Vector<D> p = grown.frame().apply(sum.support(grown.frame().pull_back(v), counters).point);
    double inside = 0;
    for (const Vector<D> q : grown.hull().vertices()) inside = std::max(inside, q.dot(v));
    EXPECT_LE(p.dot(v), grown.reached() * inside) << "D = " << D;
  }
}

TEST(ApproximateMinkowskiSum, ABudgetKeepsWhatIsCertifiedSoFar) {
  check_growth_by_budget<3>(400);
  check_growth_by_budget<4>(3000);
}

TEST(ApproximateMinkowskiSum, RefusesByName) {
  const auto body = prepare<2>({{0, 0}, {1, 0}, {0, 1}}, 0.1, Backend::kernel);
  EXPECT_EQ(approximate_minkowski_sum<2>(body, 0.1, Representation::points).error().where, "epsilon");
  EXPECT_EQ(approximate_minkowski_sum<2>(body, 1.0, Representation::points).error().code, ErrorCode::bad_value);
}

}  // namespace
}  // namespace pd::dimension::test
