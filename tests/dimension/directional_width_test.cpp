// Kernels and the structures of directional width queries against scans of all points.

#include "pd/dimension/directional_width.hpp"

#include <gtest/gtest.h>

#include "dimension/families.hpp"
#include "pd/dimension/duality.hpp"
#include "pd/dimension/epsilon_kernel.hpp"
#include "pd/dimension/expanded_body.hpp"

namespace pd::dimension {
namespace {

using namespace test;

template <int D>
void check_points(int family, int n, double epsilon, Random& random) {
  SCOPED_TRACE(family_name(family) + ", d = " + std::to_string(D) + ", epsilon = " + std::to_string(epsilon));
  const auto body = Body<D>::from_points(family_points<D>(family, n, random));
  ASSERT_TRUE(body) << body.error().message;
  const auto kernel = epsilon_kernel<D>(*body, epsilon);
  ASSERT_TRUE(kernel);
  std::vector<Vector<D>> chosen;
  for (const std::int64_t i : kernel->indices) chosen.push_back(body->points()[static_cast<std::size_t>(i)]);
  const auto approximate = DirectionalWidth<D>::build(*body, epsilon, Backend::kernel);
  const auto exact = DirectionalWidth<D>::build(*body, epsilon, Backend::exact);
  ASSERT_TRUE(approximate && exact);
  QueryCounters counters;
  for (const Vector<D>& v : hard_directions<D>(*body, 12, random)) {
    const double width = scanned_extent<D>(body->points(), v), support = scanned_support<D>(body->points(), v);
    ASSERT_GE(scanned_extent<D>(chosen, v), (1 - epsilon) * width);
    const auto answer = approximate->width(v, counters);
    ASSERT_GE(answer.width * v.norm(), (1 - epsilon) * width * (1 - 1e-15));
    ASSERT_GE(answer.most.value, support - epsilon * width);
    ASSERT_LE(answer.most.value, support);
    ASSERT_EQ(answer.most.point, body->points()[static_cast<std::size_t>(answer.most.index)]);
    // The exact backend: the same bits as the scan.
    ASSERT_EQ(exact->support(v, counters).value, support);
    ASSERT_EQ(exact->support(v, counters).index, body->support(v).index);
  }
}

template <int D>
void check_all(std::initializer_list<double> epsilons, int rounds) {
  Random random(1000 + D);
  for (int round = 0; round < rounds; ++round) {
    for (int family = 0; family < kFamilies; ++family) {
      for (const double epsilon : epsilons) check_points<D>(family, 60 + 100 * round, epsilon, random);
    }
  }
}

TEST(DirectionalWidth, IsWithinEpsilonInThePlane) { check_all<2>({0.9, 0.3, 1e-2, 1e-4, 1e-6}, 4); }
TEST(DirectionalWidth, IsWithinEpsilonInSpace) { check_all<3>({0.9, 0.3, 1e-2, 1e-3, 1e-6}, 4); }
TEST(DirectionalWidth, IsWithinEpsilonInFourDimensions) { check_all<4>({0.5, 0.1, 1e-2}, 2); }
TEST(DirectionalWidth, IsWithinEpsilonInFiveDimensions) { check_all<5>({0.5, 0.1}, 2); }

TEST(EpsilonKernel, OfAGridIsItsCornersAndFewPointsOfItsFaces) {
  std::vector<Vector<3>> points;
  for (int i = 0; i < 21 * 21 * 21; ++i) points.push_back(Vector<3>(i % 21, i / 21 % 21, i / 441));
  const auto kernel = epsilon_kernel<3>(*Body<3>::from_points(points), 1e-3);
  ASSERT_TRUE(kernel);
  for (const std::int64_t corner : {0, 20, 420, 440, 8820, 8840, 9240, 9260}) {
    EXPECT_TRUE(std::binary_search(kernel->indices.begin(), kernel->indices.end(), corner));
  }
  // Points of faces that came before the corners stay where the later hull does not bury them.
  EXPECT_LE(kernel->indices.size(), 24u);
}

TEST(EpsilonKernel, GrowsAsTheTheorySays) {
  // 2.4 / epsilon is the least number of vertices of a polytope within epsilon of a sphere; O(1 / epsilon) is allowed.
  Random random(5);
  const auto body = Body<3>::from_points(family_points<3>(0, 40000, random));
  const auto coarse = epsilon_kernel<3>(*body, 0.1), fine = epsilon_kernel<3>(*body, 0.01);
  EXPECT_LE(coarse->indices.size(), 60u);
  EXPECT_LE(fine->indices.size(), 600u);
  EXPECT_GE(fine->indices.size(), 240u);
}

TEST(EpsilonKernel, OfAStreamIsAKernelOfTheWhole) {
  Random random(11);
  // Sorted, so that the stream begins with a flat set far from the rest.
  std::vector<Vector<3>> points = family_points<3>(4, 3000, random);
  std::sort(points.begin(), points.end(), [](const auto& a, const auto& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  });
  EpsilonKernelStream<3> kernel = *EpsilonKernelStream<3>::create(0.01);
  const std::span<const Vector<3>> all = points;
  const auto chunk = [&](std::size_t i) { return all.subspan(i, std::min<std::size_t>(100, all.size() - i)); };
  for (std::size_t i = 0; i < all.size(); i += 100) ASSERT_FALSE(kernel.survey(chunk(i)));
  ASSERT_FALSE(kernel.end_survey());
  for (std::size_t i = 0; i < all.size(); i += 100) kernel.select(chunk(i));
  const EpsilonKernel<3> result = kernel.finish();
  const std::vector<Vector<3>> chosen = kernel.kernel_points();
  ASSERT_EQ(chosen.size(), result.indices.size());
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    ASSERT_EQ(chosen[i], points[static_cast<std::size_t>(result.indices[i])]);
  }
  for (int i = 0; i < 200; ++i) {
    const Vector<3> v = random_direction<3>(random);
    ASSERT_GE(scanned_extent<3>(chosen, v), 0.99 * scanned_extent<3>(points, v));
  }
}

TEST(EpsilonKernel, RefusesByName) {
  Random random(3);
  const auto body = Body<2>::from_points(family_points<2>(0, 20, random));
  EXPECT_EQ(epsilon_kernel<2>(*body, 0).error().code, ErrorCode::bad_value);
  EXPECT_EQ(epsilon_kernel<2>(*body, 1).error().code, ErrorCode::bad_value);
  EXPECT_EQ(epsilon_kernel<2>(*body, NAN).error().code, ErrorCode::bad_value);
  EXPECT_EQ(DirectionalWidth<2>::build(*body, -1).error().where, "epsilon");
  const auto square = Body<2>::from_halfspaces(
      {{Vector<2>(1, 0), 1}, {Vector<2>(-1, 0), 1}, {Vector<2>(0, 1), 1}, {Vector<2>(0, -1), 1}});
  ASSERT_TRUE(square) << square.error().message;
  EXPECT_EQ(epsilon_kernel<2>(*square, 0.1).error().code, ErrorCode::unsupported);
  EpsilonKernelStream<2> kernel = *EpsilonKernelStream<2>::create(0.1);
  const std::vector<Vector<2>> flat(100, Vector<2>(1, 2));
  EXPECT_FALSE(kernel.survey(flat));
  EXPECT_EQ(kernel.end_survey()->code, ErrorCode::not_full_dimensional);
}

TEST(ExpandedBody, WidthsGrowByOnePlusEpsilonAndLemma12Holds) {
  Random random(17);
  const auto body = Body<3>::from_points(family_points<3>(6, 100, random));
  const auto exact = DirectionalWidth<3>::build(*body, 0.1, Backend::exact);
  const ExpandedBody<3, DirectionalWidth<3>> grown(*exact, 0.3);
  const DifferenceBody<3, DirectionalWidth<3>> difference(*exact);
  QueryCounters counters;
  for (const Vector<3>& v : hard_directions<3>(*body, 30, random)) {
    const double width = scanned_extent<3>(body->points(), v), support = scanned_support<3>(body->points(), v);
    const double room = 1e-12 * (std::abs(support) + v.norm());
    EXPECT_NEAR(grown.support(v, counters).value, support + 0.15 * width, room);
    EXPECT_NEAR(grown.support(v, counters).value + grown.support(-v, counters).value, 1.3 * width, room);
    EXPECT_NEAR(difference.support(v, counters).value, width, room);
  }
}

TEST(MappedWidth, IsTheWidthOfTheImage) {
  Random random(23);
  const auto body = Body<4>::from_points(family_points<4>(0, 200, random));
  const auto exact = DirectionalWidth<4>::build(*body, 0.1, Backend::exact);
  const AffineMap<4> map{random_stretch<4>(random, 50), random_direction<4>(random)};
  const auto image = body->transformed(map);
  ASSERT_TRUE(image);
  QueryCounters counters;
  const MappedWidth<4> mapped{&*exact, map};
  for (int i = 0; i < 100; ++i) {
    const Vector<4> v = random_direction<4>(random);
    EXPECT_NEAR(mapped.support(v, counters).value, image->support(v).value, 1e-11);
  }
}

template <int D>
void check_duality() {
  Random random(31 + D);
  const std::vector<Vector<D>> points = family_points<D>(1, 40, random);
  for (int i = 0; i < 50; ++i) {
    const Vector<D> p = points[random() % points.size()], q = points[random() % points.size()];
    EXPECT_EQ(dual_point<D>(dual_hyperplane<D>(p)), p);
    // p lies above q* exactly when q lies above p*.
    const double p_above = p[D - 1] - dual_hyperplane<D>(q).height(p.template head<D - 1>());
    const double q_above = q[D - 1] - dual_hyperplane<D>(p).height(q.template head<D - 1>());
    EXPECT_NEAR(p_above, q_above, 1e-14);
    // Lemma 11.
    Vector<D> v = random_direction<D>(random);
    v /= -v[D - 1];
    EXPECT_NEAR(thickness<D>(points, v.template head<D - 1>()), scanned_extent<D>(points, v), 1e-12 * v.norm());
  }
}

TEST(Duality, IsAnInvolutionThatTurnsWidthIntoThickness) {
  check_duality<2>();
  check_duality<3>();
  check_duality<5>();
}

TEST(DirectionalWidth, AlongTheShortestAndTheLongestDirections) {
  const auto body =
      *Body<2>::from_points(std::vector<Vector<2>>{Vector<2>(0, 0), Vector<2>(1, 0), Vector<2>(0, 1), Vector<2>(1, 1)});
  QueryCounters counters;
  for (const Backend backend : {Backend::exact, Backend::kernel, Backend::macbeath}) {
    const auto width = *DirectionalWidth<2>::build(body, 0.01, backend);
    const double expected = width.width(Vector<2>(1, 1), counters).width;
    for (const double length : {5e-324, 1e-310, 1e-200, 1e200, 1e308}) {
      EXPECT_NEAR(width.width(Vector<2>(length, length), counters).width, expected, 1e-12) << length;
    }
  }
}

TEST(EpsilonKernel, OfAStreamOutOfOrderIsEmpty) {
  const std::vector<Vector<2>> points{Vector<2>(0, 0), Vector<2>(1, 0), Vector<2>(0, 1)};
  auto stream = *EpsilonKernelStream<2>::create(0.1);
  stream.select(points);
  EXPECT_TRUE(stream.finish().indices.empty());
  EXPECT_TRUE(stream.kernel_points().empty());
  EXPECT_FALSE(stream.survey(points));
  EXPECT_FALSE(stream.end_survey());
  const auto late = stream.survey(points);
  ASSERT_TRUE(late);
  EXPECT_EQ(late->code, ErrorCode::bad_value);
  stream.select(points);
  EXPECT_EQ(stream.finish().indices.size(), 3u);

  auto moved = *EpsilonKernelStream<2>::create(0.1);
  const auto taken = std::move(moved);
  EXPECT_TRUE(moved.survey(points));            // NOLINT(bugprone-use-after-move)
  EXPECT_TRUE(moved.end_survey());              // NOLINT(bugprone-use-after-move)
  EXPECT_TRUE(moved.finish().indices.empty());  // NOLINT(bugprone-use-after-move)
}

}  // namespace
}  // namespace pd::dimension
