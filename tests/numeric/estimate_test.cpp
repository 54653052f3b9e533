// Doubles with an error bound: the bound holds, and a sign is claimed only where it is certain.
#include "numeric/estimate.hpp"

#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <random>

namespace {

using pd::detail::Dyadic;
using pd::detail::Estimate;
using Rational = boost::multiprecision::cpp_rational;

double number(std::mt19937_64& bits, int exponents) {
  const double fraction = static_cast<double>(bits() >> 11) * 0x1p-53 + 0.5;
  const int exponent = static_cast<int>(bits() % static_cast<unsigned>(2 * exponents + 1)) - exponents;
  return std::ldexp(bits() % 2 ? fraction : -fraction, exponent);
}

template <class N>
N expression(const std::array<double, 5>& x) {
  return (N(x[0]) - N(x[1])) * (N(x[2]) + N(x[3]) * N(x[4])) - N(x[0]) * N(x[2]) + N(x[1]) * N(x[2]);
}

TEST(Estimate, TheBoundHolds) {
  std::mt19937_64 bits(1);
  for (const int exponents : {2, 60, 300}) {
    for (int i = 0; i < 3000; ++i) {
      std::array<double, 5> x;
      for (double& value : x) value = number(bits, exponents);
      if (i % 2 == 0) x[1] = x[0] * (1 + 0x1p-50);  // cancels
      const Estimate e = expression<Estimate>(x);
      const Rational truth = expression<Rational>(x);
      ASSERT_LE(abs(truth - Rational(e.value)), Rational(e.error));
      const int sign = pd::detail::exact_sign([&]<class N>() { return expression<N>(x); });
      ASSERT_EQ(sign, truth.sign());
    }
  }
}

TEST(Estimate, NothingIsClaimedOfWhatOverflows) {
  const auto huge = [&]<class N>() { return N(1e300) * N(1e300) - N(1e300) * N(0x1.0000000000001p0) * N(1e300); };
  EXPECT_EQ(huge.template operator()<Estimate>().certain_sign(), 0);
  EXPECT_EQ(pd::detail::exact_sign(huge), -1);
}

TEST(Estimate, ProductsBelowTheSmallestDouble) {
  const auto tiny = [&]<class N>() { return N(0x1p-1000) * N(0x1p-1000); };
  EXPECT_EQ(tiny.template operator()<Estimate>().certain_sign(), 0);
  EXPECT_EQ(pd::detail::exact_sign(tiny), 1);
}

TEST(Estimate, ExactZerosNeedNoBigNumbers) {
  EXPECT_TRUE((Estimate(0.0) * Estimate(3.0)).is_zero());
  EXPECT_TRUE((Estimate(1.0) - Estimate(1.0) * Estimate(1.0)).is_zero());
  EXPECT_TRUE((Estimate(0.5) + Estimate(-0.5)).is_zero());
  // The products round, and may have rounded apart.
  EXPECT_FALSE((Estimate(0.1) * Estimate(0.3) - Estimate(0.3) * Estimate(0.1)).is_zero());
  // The sum rounds: 2^-60 is lost in it.
  EXPECT_FALSE((Estimate(1.0) + Estimate(0x1p-60) - Estimate(1.0)).is_zero());
}

/// Some are short, some have one bit too many, and sizes reach beyond those whose products are exact.
TEST(Estimate, ProductsWithoutAnErrorAreExact) {
  std::mt19937_64 bits(5);
  int exact = 0;
  for (int i = 0; i < 20'000; ++i) {
    const auto some = [&] {
      const int kept = 22 + static_cast<int>(bits() % 5);
      const double size = static_cast<double>((bits() >> (64 - kept)) | 1U);
      const double whole = bits() % 2 ? size : -size;
      return std::ldexp(whole, static_cast<int>(bits() % 1400) - 700);
    };
    const double a = some(), b = some();
    const Estimate product = Estimate(a) * Estimate(b);
    if (product.error != 0) continue;
    ++exact;
    ASSERT_EQ(Rational(product.value), Rational(a) * Rational(b)) << a << " * " << b;
  }
  EXPECT_GT(exact, 1000);
  EXPECT_EQ((Estimate(0x1.fffffep0) * Estimate(0x1.fffffep0)).error, 0);
  EXPECT_GT((Estimate(0x1.ffffffp0) * Estimate(0x1.ffffffp0)).error, 0);
}

}  // namespace
