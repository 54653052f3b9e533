// Our sine against the library's in long double, and rotations that stay rotations.
#include "numeric/turn.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace pd::detail {
namespace {

TEST(Turn, SineIsWithinTwoUnits) {
  std::mt19937_64 random(71);
  std::uniform_real_distribution<double> exponent(-60, 19);
  std::uniform_real_distribution<double> mantissa(-2, 2);
  for (int i = 0; i < 200'000; ++i) {
    const double part = mantissa(random);
    const double angle = std::ldexp(part, static_cast<int>(exponent(random)));
    const long double wanted = std::sin(static_cast<long double>(angle));
    const double allowed = 0x1p-51 * static_cast<double>(std::abs(wanted)) + 0x1p-80 * std::abs(angle);
    ASSERT_NEAR(sine(angle), static_cast<double>(wanted), allowed) << std::hexfloat << angle;
  }
}

TEST(Turn, WholeQuartersKeepTheirDigits) {
  EXPECT_EQ(sine(0), 0);
  EXPECT_EQ(sine(0x1.921fb54442d18p+0), 1);                      // the double next to pi/2
  EXPECT_EQ(sine(0x1.921fb54442d18p+1), 0x1.1a62633145c07p-53);  // what pi is above its double
  EXPECT_EQ(sine(-0x1.921fb54442d18p+1), -0x1.1a62633145c07p-53);
}

TEST(Turn, AngleOfManyTurnsIsOffByItsOwnRounding) {
  for (const double angle : {1e7, 3e9, 1e15}) {
    const auto wanted = static_cast<double>(std::sin(static_cast<long double>(angle)));
    EXPECT_NEAR(sine(angle), wanted, 0x1p-52 * angle);
  }
  EXPECT_LE(std::abs(sine(1e300)), 1 + 0x1p-52);
}

TEST(Turn, RotationsAreRotations) {
  std::mt19937_64 random(72);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 10'000; ++i) {
    const Vec3 axis = Vec3{normal(random), normal(random), normal(random)}.normalized();
    const double angle = 3 * normal(random);
    const Mat3 turn = rotation_about(axis, angle);
    EXPECT_LT((turn.transpose() * turn - Mat3::Identity()).norm(), 0x1p-48);
    const Vec3 v{normal(random), normal(random), normal(random)};
    EXPECT_LT((turn * v - turned(v, axis, angle)).norm(), 0x1p-49 * v.norm());
    EXPECT_LT((turned(turned(v, axis, angle), axis, -angle) - v).norm(), 0x1p-48 * v.norm());
  }
}

}  // namespace
}  // namespace pd::detail
