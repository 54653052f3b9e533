#include "numeric/length.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <random>

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

}  // namespace

}  // namespace pd::detail
