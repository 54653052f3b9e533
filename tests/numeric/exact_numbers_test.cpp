// Dyadic, double-double and root sums: the numbers behind the last bits of every answer.
#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <limits>
#include <random>

#include "numeric/double_double.hpp"
#include "numeric/dyadic.hpp"
#include "numeric/root_sum.hpp"
#include "numeric/unrounded.hpp"

namespace {

using pd::detail::DoubleDouble;
using pd::detail::Dyadic;
using pd::detail::RootSum;
using Rational = boost::multiprecision::cpp_rational;

Rational rational(double x) { return Rational(x); }

/// Doubles of every size that the arithmetic must survive.
class Numbers {
 public:
  explicit Numbers(int exponents) : exponents_(exponents) {}
  double operator()() {
    const double fraction = static_cast<double>(bits_() >> 11) * 0x1p-53 + 0.5;
    const int exponent = static_cast<int>(bits_() % static_cast<unsigned>(2 * exponents_ + 1)) - exponents_;
    return std::ldexp(bits_() % 2 ? fraction : -fraction, exponent);
  }

 private:
  std::mt19937_64 bits_{20261121};
  int exponents_;
};

TEST(Dyadic, SumsAndProductsAreExactAtEveryScale) {
  Numbers next(1000);
  for (int i = 0; i < 200; ++i) {
    const double a = next(), b = next(), c = next();
    const Dyadic value = Dyadic(a) * Dyadic(b) - Dyadic(c);
    const Rational expected = rational(a) * rational(b) - rational(c);
    EXPECT_EQ(value.sign(), expected.sign());
    EXPECT_EQ((value + Dyadic(c) - Dyadic(a) * Dyadic(b)).sign(), 0);
  }
}

TEST(Dyadic, SumsAreExactAcrossTheLengthOfALimb) {
  using Integer = Dyadic::Integer;
  const Integer most = (Integer(1) << 64) - 1;
  for (const Integer& m : {most, Integer(-most), Integer(1), Integer(-3)}) {
    for (unsigned shift = 0; shift <= 80; ++shift) {
      const Dyadic high = Dyadic::from_integer(m, static_cast<int>(shift) - 7), low = Dyadic::from_integer(most, -7);
      const auto expect = [&](const Dyadic& value, const Integer& whole) {
        EXPECT_EQ((value - Dyadic::from_integer(whole, -7)).sign(), 0) << m << " << " << shift;
        EXPECT_EQ(value.sign(), whole.sign());
      };
      expect(high + low, Integer((m << shift) + most));
      expect(low + high, Integer((m << shift) + most));
      expect(high - low, Integer((m << shift) - most));
      expect(low - high, Integer(most - (m << shift)));
    }
  }
}

TEST(UnroundedSum, KnowsWhetherAStepRounds) {
  const auto exact = [](const auto& steps) {
    pd::detail::UnroundedSum sum;
    steps(sum);
    return sum.exact();
  };
  pd::detail::UnroundedSum whole;
  whole.add_product(3, 0.125);
  whole.add_product(-1, 0.25);
  whole.add(0.25);
  whole.add_product(0, 1e300);
  EXPECT_TRUE(whole.exact());
  EXPECT_EQ(whole.value(), 0.375);
  EXPECT_FALSE(exact([](auto& s) { s.add(1), s.add(0x1p-60), s.add(-1); }));
  EXPECT_FALSE(exact([](auto& s) { s.add_product(0.1, 0.1); }));
  EXPECT_FALSE(exact([](auto& s) { s.add_product(0x1p-500, 0x1p-500); }));  // the error of such a product may be lost
  EXPECT_FALSE(exact([](auto& s) { s.add_product(0x1p600, 0x1p600); }));
  EXPECT_FALSE(exact([](auto& s) { s.add(0x1p1023), s.add(0x1p1023); }));
}

TEST(Dyadic, RoundsDownAndUpToNeighbours) {
  Numbers next(40);
  for (int i = 0; i < 500; ++i) {
    const double a = next(), b = next();
    const Dyadic value = Dyadic(a) * Dyadic(b);
    const double down = value.round_down();
    const double up = value.round_up();
    const Rational exact = rational(a) * rational(b);
    EXPECT_LE(rational(down), exact);
    EXPECT_GE(rational(up), exact);
    EXPECT_TRUE(up == down || up == std::nextafter(down, HUGE_VAL)) << a << " * " << b;
  }
}

TEST(Dyadic, RoundsBelowTheSmallestNormal) {
  const double tiny = std::numeric_limits<double>::denorm_min();
  const Dyadic half = Dyadic(tiny) * Dyadic(0.5);
  EXPECT_EQ(half.round_down(), 0.0);
  EXPECT_EQ(half.round_up(), tiny);
  EXPECT_EQ((-half).round_down(), -tiny);
  EXPECT_EQ(Dyadic(tiny).round_down(), tiny);
}

TEST(DoubleDouble, ProductAndQuotientKeepAHundredBits) {
  Numbers next(20);
  for (int i = 0; i < 500; ++i) {
    const double factors[] = {next(), next()}, summands[] = {next(), next()};
    const DoubleDouble a = pd::detail::two_product(factors[0], factors[1]);
    const DoubleDouble b = pd::detail::two_sum(summands[0], summands[1]);
    const auto value = [](const DoubleDouble& x) { return rational(x.hi) + rational(x.lo); };
    const Rational bound = Rational(1) / (boost::multiprecision::cpp_int(1) << 100);
    const Rational product = value(a) * value(b);
    EXPECT_LE(abs(value(a * b) - product), abs(product) * bound);
    const Rational quotient = value(a) / value(b);
    EXPECT_LE(abs(value(a / b) - quotient), abs(quotient) * bound);
    const DoubleDouble square = a * a;
    const Rational root = value(sqrt(square));
    EXPECT_LE(abs(root - abs(value(a))), abs(root) * bound * 4);
  }
}

TEST(RootSum, ComparesExactlyWhereDoublesCannot) {
  // 1 - sqrt(1 - 2^-120): about 2^-121, lost in any fixed precision.
  const Dyadic one(1.0);
  const Dyadic numerator = one - Dyadic(std::ldexp(1.0, -120));
  const RootSum value(one, -1, numerator, one);
  EXPECT_EQ(value.compare(Dyadic()), 1);
  EXPECT_EQ(value.compare(Dyadic(std::ldexp(1.0, -122))), 1);
  EXPECT_EQ(value.compare(Dyadic(std::ldexp(1.0, -120))), -1);
  const double down = value.round_down();
  EXPECT_GE(value.compare(Dyadic(down)), 0);
  EXPECT_LT(value.compare(Dyadic(std::nextafter(down, HUGE_VAL))), 0);
}

TEST(RootSum, ApproximatesToManyDigitsWhereAllButFewCancel) {
  // r - sqrt(r^2 - 2 r d + d^2) = d: for every d, whatever is left of r.
  const Dyadic r(0.07999999821186066);
  for (int bits = 0; bits <= 200; bits += 5) {
    const Dyadic d(std::ldexp(0.7, -bits));
    const Dyadic root = r - d;
    const RootSum value(r, -1, root * root * Dyadic(3.0), Dyadic(3.0));
    const auto x = value.approximate();
    const Dyadic error = Dyadic(x.hi) + Dyadic(x.lo) - (root.sign() > 0 ? d : r + root);
    EXPECT_LE(std::abs(error.to_double()), RootSum::kApproximationError * d.to_double()) << bits;
  }
}

TEST(RootSum, RoundsRationalRootsToThemselves) {
  const RootSum five(Dyadic(0.0), 1, Dyadic(25.0), Dyadic(1.0));
  EXPECT_EQ(five.round_down(), 5.0);
  EXPECT_EQ(five.round_up(5.0), 5.0);
  const RootSum root_two(Dyadic(0.0), 1, Dyadic(2.0), Dyadic(1.0));
  EXPECT_EQ(root_two.round_down(), 0x1.6a09e667f3bccp0);
  EXPECT_EQ(root_two.round_up(root_two.round_down()), 0x1.6a09e667f3bcdp0);
}

TEST(RootSum, SurvivesScalesWhoseSquaresOverflow) {
  const Dyadic huge(1e200);
  const RootSum value(Dyadic(0.0), 1, huge * huge * Dyadic(2.0), Dyadic(1.0));
  EXPECT_NEAR(value.round_down() / 1e200, std::sqrt(2.0), 1e-15);
  const Dyadic tiny(1e-200);
  const RootSum small(Dyadic(0.0), 1, tiny * tiny * Dyadic(2.0), Dyadic(1.0));
  EXPECT_NEAR(small.round_down() / 1e-200, std::sqrt(2.0), 1e-15);
}

TEST(RootSum, RoundsDownToTheLargestDoubleWhatIsBeyondIt) {
  const double largest = std::numeric_limits<double>::max();
  const Dyadic whole(largest);
  for (const double factor : {1.0, 2.0, 0x1p100}) {
    const Dyadic root = whole * Dyadic(factor);
    EXPECT_EQ(RootSum(Dyadic(0.0), 1, root * root, Dyadic(1.0)).round_down(), largest) << factor;
    // Nothing of the sum is in range but one part.
    EXPECT_EQ(RootSum(whole, 1, root * root, Dyadic(1.0)).round_down(), largest) << factor;
  }
  const double below = std::nextafter(largest, 0);
  EXPECT_EQ(RootSum(Dyadic(0.0), 1, Dyadic(below) * Dyadic(below), Dyadic(1.0)).round_down(), below);
}

TEST(RootSum, RoundsDownWhereTheApproximationSaysNothing) {
  // What is left of base and root is an ordinary number; they themselves have no double near them.
  const Dyadic huge = Dyadic(1.0).scaled(1100);
  for (const double left : {3.0, 3.1, 1e-300, 5e-324, 1e300}) {
    const Dyadic above = huge + Dyadic(left), below = huge - Dyadic(left);
    EXPECT_EQ(RootSum(-huge, 1, above * above, Dyadic(1.0)).round_down(), left);
    EXPECT_EQ(RootSum(huge, -1, below * below, Dyadic(1.0)).round_down(), left);
  }
}

TEST(RootSum, RoundsDownAmongSubnormalNumbers) {
  for (const int k : {1, 2, 3, 5, 17, 1000, 123457}) {
    const Dyadic x(k * 0x1p-1074);
    const double down = RootSum(Dyadic(0.0), 1, x * x * Dyadic(2.0), Dyadic(1.0)).round_down();
    EXPECT_EQ(down, std::floor(k * std::sqrt(2.0)) * 0x1p-1074) << k;
  }
}

}  // namespace
