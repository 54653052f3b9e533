/// @file
/// Quadruple precision against the integers that it stands for, and verdicts with it against verdicts without.

#include "oracle/quad_filter.hpp"

#include <gtest/gtest.h>

#include "oracle/depth_oracle.hpp"
#include "scenes/shape_families.hpp"

namespace pd::oracle {
namespace {

using scenes::DepthClass;
using scenes::PairFamily;

/// Calls `visit(pair, family)` for pairs of every family and depth class.
template <typename Visit>
void for_each_pair(int n, int seeds, const Visit& visit) {
  for (int f = 0; f < scenes::kPairFamilies; ++f) {
    for (int d = 0; d < scenes::kDepthClasses; ++d) {
      for (int seed = 1; seed <= seeds; ++seed) {
        const auto family = static_cast<PairFamily>(f);
        const auto depth = static_cast<DepthClass>(d);
        SCOPED_TRACE(std::string(to_string(family)) + " " + std::string(to_string(depth)) + " seed " +
                     std::to_string(seed));
        const scenes::PointPair p = scenes::make_pair(family, n, depth, static_cast<std::uint64_t>(seed));
        const Body a(p.a);
        const Body b(p.b);
        visit(ExactPair(a, p.pose_a, b, p.pose_b), family);
      }
    }
  }
}

Scaled exactly(Quad value) {
  Scaled sum;
  for (int part = 0; part < 3; ++part) {  // 53 bits each
    const auto head = static_cast<double>(value);
    sum = sum + to_scaled(head);
    value -= head;
  }
  EXPECT_TRUE(value == 0);
  return sum;
}

/// Sign of bound - (h / |n|)^2, h in the pair's integers.
int compare(const Quad& bound, const Integer& h, const IVec& n, int unit_exponent) {
  return (exactly(bound) * Scaled{dot(n, n), 0} - Scaled{h * h, -2 * unit_exponent}).mantissa.sign();
}

/// Directions of P's facets and others: cross products of differences of the points.
std::vector<IVec> directions(const ExactPair& pair) {
  std::vector<IVec> differences;
  for (int i = 1; i < std::min<int>(6, static_cast<int>(pair.a().exact.size())); ++i) {
    differences.push_back(pair.point_a(i) - pair.point_a(i - 1));
  }
  for (int i = 1; i < std::min<int>(6, static_cast<int>(pair.b().exact.size())); ++i) {
    differences.push_back(pair.point_b(i) - pair.point_b(i - 1));
  }
  std::vector<IVec> result;
  for (const IVec& e : differences) {
    for (const IVec& f : differences) {
      IVec n = cross(e, f);
      if (!is_zero(n)) result.push_back(std::move(n));
    }
  }
  return result;
}

TEST(QuadFilter, BoundsHoldTheExactHeight) {
  int positive = 0;
  int negative = 0;
  int unknown = 0;
  for_each_pair(8, 8, [&](const ExactPair& pair, PairFamily) {
    QuadFilter filter(pair);
    for (const IVec& n : directions(pair)) {
      const Vec3 unit = to_unit(n);
      const auto height = filter.squared_height(n, unit);
      ASSERT_TRUE(height);
      const Integer h = pair.exact_support(n, unit);
      if (height->negative) {
        EXPECT_LT(h.sign(), 0);
        ++negative;
        continue;
      }
      EXPECT_LE(compare(height->lower, h, n, filter.unit_exponent()), 0);
      EXPECT_GE(compare(height->upper, h, n, filter.unit_exponent()), 0);
      EXPECT_TRUE(height->lower == 0 || h.sign() > 0);
      // The distance that is stated.
      const double top = std::sqrt(static_cast<double>(height->upper));
      EXPECT_LE(static_cast<double>(height->upper - height->lower), 0x1p-99 * (top + 0x1p-99));
      ++(height->lower == 0 ? unknown : positive);
    }
  });
  std::printf("%d positive, %d negative, %d of unknown sign\n", positive, negative, unknown);
  EXPECT_GT(positive, 1000);
  EXPECT_GT(negative, 100);
  EXPECT_GT(unknown, 100);
}

TEST(QuadFilter, IntegersAreTruncatedAtTheirHundredAndThirteenthBit) {
  const Integer ones = (Integer(1) << 113) - 1;
  const Scaled exact = exactly(to_quad(ones, -113));
  EXPECT_EQ(exact.mantissa, ones);
  EXPECT_EQ(exact.exponent, -113);
  EXPECT_TRUE(to_quad((ones << 500) + 7, -613) == to_quad(ones, -113));
  EXPECT_TRUE(to_quad(-ones, -113) == -to_quad(ones, -113));
  EXPECT_TRUE(to_quad(Integer(1), -300) == 0x1p-300);
  EXPECT_TRUE(to_quad(Integer(1), -301) == 0);
  EXPECT_TRUE(to_quad(Integer(0), 5) == 0);
}

TEST(QuadFilter, VerdictsAreTheSameWithout) {
  int with_filter = 0;
  int without = 0;
  for (const int n : {6, 24}) {
    for_each_pair(n, 3, [&](const ExactPair& pair, PairFamily family) {
      const Verdict fast = judge(pair, {.distance = false, .quad_filtering = QuadFiltering::always});
      const Verdict plain = judge(pair, {.distance = false, .quad_filtering = QuadFiltering::never});
      EXPECT_EQ(fast.contact, plain.contact);
      EXPECT_EQ(fast.depth.compare(plain.depth), 0);
      ASSERT_EQ(fast.normals.size(), plain.normals.size());
      for (std::size_t k = 0; k < fast.normals.size(); ++k) {
        EXPECT_TRUE(is_zero(fast.normals[k] - plain.normals[k]));
        EXPECT_EQ(fast.unit_normals[k], plain.unit_normals[k]);
      }
      EXPECT_LE(fast.compared_exactly, plain.compared_exactly);
      const Verdict usual = judge(pair, {.distance = false});
      EXPECT_EQ(usual.contact, plain.contact);
      EXPECT_EQ(usual.depth.compare(plain.depth), 0);
      EXPECT_EQ(usual.normals.size(), plain.normals.size());
      if (family == PairFamily::ulp_noise) {
        with_filter += fast.compared_exactly;
        without += plain.compared_exactly;
      }
    });
  }
  std::printf("ulp_noise: %d exact comparisons with the filter, %d without\n", with_filter, without);
  // What is left are ties.
  EXPECT_GT(without, 500);
  EXPECT_LT(with_filter, without / 50);
}

}  // namespace
}  // namespace pd::oracle
