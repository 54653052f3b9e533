#include "numeric/length.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

#include "pd/numeric/vector.hpp"

namespace pd::detail {

namespace {

/// The exact length in long double, whose roots have eleven bits more.
long double reference(double x, double y) {
  const long double a = x, b = y;
  return std::sqrt(a * a + b * b);
}

TEST(Length, WithinTwoBitsOfTheExactOneAtEveryScale) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> mantissa(-2, 2);
  std::uniform_int_distribution<int> exponent(-1070, 1020);
  for (int i = 0; i < 100000; ++i) {
    const int e = exponent(random);
    const double x = std::ldexp(mantissa(random), e), y = std::ldexp(mantissa(random), e - i % 60);
    const long double exact = reference(x, y);
    const double slack = std::numeric_limits<double>::denorm_min();
    EXPECT_NEAR(static_cast<double>(length(x, y) - exact), 0, static_cast<double>(exact) * 0x1p-51 + slack)
        << x << " " << y;
  }
  EXPECT_EQ(length(0, 0), 0);
  EXPECT_EQ(length(3e300, -4e300), 5e300);
  EXPECT_EQ(length(5e-324, 0), 5e-324);
  EXPECT_EQ(length(-std::numeric_limits<double>::infinity(), 1), std::numeric_limits<double>::infinity());
  EXPECT_TRUE(std::isnan(length(std::numeric_limits<double>::quiet_NaN(), 1)));
}

// Two ways to the same bits: squares as they are, and scaled where they would leave the range.
TEST(Length, ScalesByPowersOfTwo) {
  std::mt19937_64 random(8);
  std::uniform_real_distribution<double> mantissa(-2, 2);
  for (int i = 0; i < 20000; ++i) {
    const double x = mantissa(random), y = std::ldexp(mantissa(random), -(i % 500));
    const double unscaled = length(x, y);
    for (const int exponent : {-402, -401, -400, -399, 0, 398, 399, 400, 401, 500}) {
      ASSERT_EQ(length(std::ldexp(x, exponent), std::ldexp(y, exponent)), std::ldexp(unscaled, exponent)) << x << y;
    }
  }
}

/// Of three coordinates: the same bits wherever the vector lies (Eigen's stableNorm has others where its address is odd
/// to a packet's), and at every size.
TEST(Length, OfAVectorHasTheBitsOfItsCoordinatesAlone) {
  std::mt19937_64 random(9);
  std::uniform_real_distribution<double> mantissa(-2, 2);
  alignas(64) double memory[4];
  for (int i = 0; i < 20000; ++i) {
    const double at[3] = {mantissa(random), std::ldexp(mantissa(random), -(i % 60)), mantissa(random)};
    const Vec3 v(at[0], at[1], at[2]);
    const double found = length(v);
    for (int shift = 0; shift < 2; ++shift) {
      std::copy(std::begin(at), std::end(at), memory + shift);
      ASSERT_EQ(length(Eigen::Map<const Vec3>(memory + shift)), found);
    }
    const long double exact =
        std::sqrt(static_cast<long double>(at[0]) * at[0] + static_cast<long double>(at[1]) * at[1] +
                  static_cast<long double>(at[2]) * at[2]);
    ASSERT_NEAR(static_cast<double>(found - exact), 0, static_cast<double>(exact) * 0x1p-51);
    for (const int exponent : {-700, -399, 399, 900}) {
      ASSERT_EQ(length(Vec3(std::ldexp(at[0], exponent), std::ldexp(at[1], exponent), std::ldexp(at[2], exponent))),
                std::ldexp(found, exponent));
    }
  }
  EXPECT_EQ(length(Vec3(Vec3::Zero())), 0);
  EXPECT_EQ(length(Vec3(0, -std::numeric_limits<double>::infinity(), 1)), std::numeric_limits<double>::infinity());
  EXPECT_TRUE(std::isnan(length(Vec3(0, std::numeric_limits<double>::quiet_NaN(), 1))));
}

}  // namespace

}  // namespace pd::detail
