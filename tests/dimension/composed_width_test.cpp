// The width of composed bodies against supports of their parts, and of boxes, whose compositions are known.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>

#include "dimension/body_families.hpp"
#include "pd/dimension/approximate_width.hpp"

namespace pd::dimension::test {
namespace {

template <int D>
ComposedBody<D> prepared(const std::vector<Vector<D>>& points, double epsilon, Backend backend) {
  const auto body = Body<D>::from_points(points);
  EXPECT_TRUE(body) << (body ? "" : body.error().message);
  return *ComposedBody<D>::of(*DirectionalWidth<D>::build(*body, epsilon, backend));
}

/// Sums (k even) and hulls (k odd) of two bodies of every family.
template <int D>
void check_pairs(Backend backend, double epsilon, double structures, int count) {
  BodySource<D> source(91);
  int k = 0;
  for (const Family family : kBodyFamilies) {
    SCOPED_TRACE(testing::Message() << "D = " << D << ", family " << k);
    const bool hull = k++ % 2 == 1;
    const auto a = source.points(family, count);
    auto b = source.points(Family::ball, count);
    for (Vector<D>& p : b) p *= 0.3;
    // Hulls ask for more, by the ratio of the composed sandwich.
    const double share = hull ? structures / 60 : structures;
    std::vector<ComposedBody<D>> parts = {prepared<D>(a, share, backend), prepared<D>(b, share, backend)};
    const auto whole = hull ? *ComposedBody<D>::hull_of(parts) : *ComposedBody<D>::sum_of(parts);
    const auto truth = [&](const Vector<D>& v) {
      const auto h = [&](const auto& points, const Vector<D>& n) { return extreme<D>(points, n).dot(n); };
      const Vector<D> w = -v;
      return hull ? std::max(h(a, v), h(b, v)) + std::max(h(a, w), h(b, w)) : h(a, v) + h(b, v) + h(a, w) + h(b, w);
    };
    const auto width = approximate_width<D>(whole, epsilon);
    ASSERT_TRUE(width) << width.error().message;
    EXPECT_LE(width->upper, (1 + epsilon) * width->lower);
    EXPECT_NEAR(width->direction.norm(), 1, 1e-14);
    const double own = truth(width->direction);
    EXPECT_LE(width->lower, own * (1 + 1e-9));
    EXPECT_GE(width->upper, own * (1 - 1e-9));
    for (int turn = 0; turn < 200; ++turn) EXPECT_GE(truth(source.direction()), width->lower * (1 - 1e-9));
  }
}

TEST(CompositionsWidth, IsBracketed) {
  check_pairs<2>(Backend::kernel, 1e-2, 1e-3, 60);
  check_pairs<2>(Backend::exact, 0.9, 1e-2, 60);
  check_pairs<2>(Backend::macbeath, 0.2, 0.02, 40);
  check_pairs<3>(Backend::kernel, 0.1, 1e-2, 60);
  check_pairs<4>(Backend::kernel, 0.5, 0.05, 40);
  check_pairs<5>(Backend::kernel, 0.9, 0.05, 20);
}

/// Of boxes with common axes: along them, widths add up, overlap, or reach from end to end.
template <int D>
void check_boxes(double epsilon) {
  BodySource<D> source(92);
  const Matrix<D> axes = source.rotation();
  std::array<Vector<D>, 2> low, high;
  std::vector<ComposedBody<D>> parts;
  for (int k = 0; k < 2; ++k) {
    for (int i = 0; i < D; ++i) {
      low[std::size_t(k)][i] = source.uniform(-1, -0.4);
      high[std::size_t(k)][i] = source.uniform(0.4, 1);
    }
    std::vector<Vector<D>> corners;
    for (int c = 0; c < (1 << D); ++c) {
      Vector<D> p;
      for (int i = 0; i < D; ++i) p[i] = ((c >> i) & 1) != 0 ? high[std::size_t(k)][i] : low[std::size_t(k)][i];
      corners.push_back(axes * p);
    }
    parts.push_back(prepared<D>(corners, 1e-4, Backend::kernel));
  }
  double sum = std::numeric_limits<double>::infinity(), meet = sum;
  for (int i = 0; i < D; ++i) {
    sum = std::min(sum, high[0][i] - low[0][i] + high[1][i] - low[1][i]);
    meet = std::min(meet, std::min(high[0][i], high[1][i]) - std::max(low[0][i], low[1][i]));
  }
  for (const auto& [body, exact] :
       {std::pair{*ComposedBody<D>::sum_of(parts), sum}, std::pair{*ComposedBody<D>::intersection_of(parts), meet}}) {
    const auto width = approximate_width<D>(body, epsilon);
    ASSERT_TRUE(width) << width.error().message;
    EXPECT_LE(width->lower, exact * (1 + 1e-9));
    EXPECT_GE(width->upper, exact * (1 - 1e-9));
    EXPECT_LE(width->upper, (1 + epsilon) * width->lower);
  }
}

TEST(CompositionsWidth, OfBoxes) {
  check_boxes<2>(0.05);
  check_boxes<3>(0.1);
  check_boxes<4>(0.3);
  check_boxes<5>(0.6);
}

TEST(CompositionsWidth, RefusesByName) {
  BodySource<2> source(93);
  const auto a = prepared<2>(source.points(Family::ball, 30), 0.05, Backend::kernel);
  for (const double epsilon : {0.0, 1.0, 1e-6, 0.05}) {  // the last: structures too coarse
    const auto width = approximate_width<2>(*ComposedBody<2>::sum_of({a, a}), epsilon);
    ASSERT_FALSE(width) << epsilon;
    EXPECT_EQ(width.error().code, ErrorCode::bad_value);
    EXPECT_EQ(width.error().where, "epsilon");
  }
  Expected<ComposedBody<2>> away =
      ComposedBody<2>::of(*DirectionalWidth<2>::build(*Body<2>::from_points(source.points(Family::ball, 30)), 1e-3),
                          AffineMap<2>{Matrix<2>::Identity(), Vector<2>(9, 0)});
  const auto near = prepared<2>(source.points(Family::ball, 30), 1e-3, Backend::kernel);
  EXPECT_FALSE(approximate_width<2>(*ComposedBody<2>::intersection_of({near, *away}), 0.1)) << "nothing in common";
}

}  // namespace
}  // namespace pd::dimension::test
