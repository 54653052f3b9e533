// Double-double in lanes: the bits of the numbers on their own.
#include "numeric/double_double_lanes.hpp"

#include <gtest/gtest.h>

#include <random>

namespace pd::detail {
namespace {

class Numbers {
 public:
  double one() {
    const double fraction = fraction_(bits_);
    return std::ldexp(fraction, exponent_(bits_));
  }
  DoubleDouble two() {
    const double high = one();
    return quick_two_sum(high, 0x1p-53 * fraction_(bits_) * high);
  }
  FourDoubleDoubles four() {
    FourDoubleDoubles out;
    for (int i = 0; i < kLanes; ++i) out.set(i, two());
    return out;
  }

 private:
  std::mt19937_64 bits_{20261124};
  std::uniform_real_distribution<double> fraction_{-1, 1};
  std::uniform_int_distribution<int> exponent_{-40, 40};
};

void expect_same(const FourDoubleDoubles& lanes, int i, const DoubleDouble& alone) {
  EXPECT_EQ(lanes.hi[i], alone.hi);
  EXPECT_EQ(lanes.lo[i], alone.lo);
}

TEST(DoubleDoubleLanes, HaveTheBitsOfTheNumbersAlone) {
  Numbers next;
  for (int round = 0; round < 2000; ++round) {
    const FourDoubleDoubles a = next.four(), b = next.four();
    DoubleDoubleLanes x, y, found;
    load(x, a);
    load(y, b);
    FourDoubleDoubles sum, difference, product, quotient, by_double, exact_product, spread_out;
    add(found, x, y);
    store(sum, found);
    subtract(found, x, y);
    store(difference, found);
    multiply(found, x, y);
    store(product, found);
    multiply(found, x, y.hi);
    store(by_double, found);
    divide(found, x, y);
    store(quotient, found);
    two_product(found, x.hi, y.hi);
    store(exact_product, found);
    spread(found, a[1]);
    store(spread_out, found);
    for (int i = 0; i < kLanes; ++i) {
      expect_same(sum, i, a[i] + b[i]);
      expect_same(difference, i, a[i] - b[i]);
      expect_same(product, i, a[i] * b[i]);
      expect_same(by_double, i, a[i] * b.hi[i]);
      expect_same(quotient, i, a[i] / b[i]);
      expect_same(exact_product, i, two_product(a.hi[i], b.hi[i]));
      expect_same(spread_out, i, a[1]);
    }
    cross(found, x, y);
    store(product, found);
    const Vec3DD alone = cross(vector_of(a), vector_of(b));
    expect_same(product, 0, alone.x);
    expect_same(product, 1, alone.y);
    expect_same(product, 2, alone.z);
  }
}

/// Results may be written over what they are made from.
TEST(DoubleDoubleLanes, MayBeTheirOwnOperands) {
  Numbers next;
  for (int round = 0; round < 200; ++round) {
    const FourDoubleDoubles a = next.four(), b = next.four();
    DoubleDoubleLanes x, y;
    FourDoubleDoubles out;
    const auto expect = [&](const auto& operation, const auto& alone) {
      load(x, a);
      load(y, b);
      operation();
      store(out, x);
      for (int i = 0; i < kLanes; ++i) expect_same(out, i, alone(i));
    };
    expect([&] { add(x, x, y); }, [&](int i) { return a[i] + b[i]; });
    expect([&] { add(x, y, x); }, [&](int i) { return b[i] + a[i]; });
    expect([&] { subtract(x, x, y); }, [&](int i) { return a[i] - b[i]; });
    expect([&] { multiply(x, x, x); }, [&](int i) { return a[i] * a[i]; });
    expect([&] { divide(x, x, y); }, [&](int i) { return a[i] / b[i]; });
    expect([&] { divide(x, y, x); }, [&](int i) { return b[i] / a[i]; });
  }
}

/// Whichever way the processor takes.
TEST(DoubleDoubleLanes, HaveTheSameBitsWithFusedProducts) {
  Numbers next;
  for (int round = 0; round < 2000; ++round) {
    const FourDoubleDoubles a = next.four(), b = next.four();
    FourDoubleDoubles exact_product, product, quotient, turned;
    DoubleDouble root_of_one;
    const DoubleDouble positive{std::abs(a.hi[0]), a.hi[0] < 0 ? -a.lo[0] : a.lo[0]};
    with_products([&](auto products) __attribute__((always_inline)) {
      using P = decltype(products);
      DoubleDoubleLanesBy<P> x, y, found;
      load(x, a);
      load(y, b);
      two_product(found, x.hi, y.hi);
      store(exact_product, found);
      multiply(found, x, y);
      store(product, found);
      divide(found, x, y);
      store(quotient, found);
      cross(found, x, y);
      store(turned, found);
      root_of_one = root<P>(positive);
    });
    for (int i = 0; i < kLanes; ++i) {
      expect_same(exact_product, i, two_product(a.hi[i], b.hi[i]));
      expect_same(product, i, a[i] * b[i]);
      expect_same(quotient, i, a[i] / b[i]);
    }
    const Vec3DD alone = cross(vector_of(a), vector_of(b));
    expect_same(turned, 0, alone.x);
    expect_same(turned, 1, alone.y);
    expect_same(turned, 2, alone.z);
    EXPECT_EQ(root_of_one.hi, sqrt(positive).hi);
    EXPECT_EQ(root_of_one.lo, sqrt(positive).lo);
  }
}

}  // namespace
}  // namespace pd::detail
