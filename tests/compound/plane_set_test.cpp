/// @file
/// Points where three planes meet, in doubles: within the bound that comes with them, exactly.
#include "compound/plane_set.hpp"

#include <gtest/gtest.h>

#include <random>

namespace pd::detail {
namespace {

TEST(PlaneSet, MeetsLieWithinTheirError) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto vector = [&] {
    const double x = unit(random), y = unit(random);
    return Vec3(x, y, unit(random));
  };
  int exactly = 0;
  for (int i = 0; i < 2000; ++i) {
    SCOPED_TRACE(i);
    // Two planes the nearer to parallel the later, so that doubles leave the point to exact numbers.
    const Vec3 first = vector(), third = vector();
    const Vec3 second = first + std::ldexp(1.0, -i / 40) * vector();
    PlaneSet planes(0);
    const auto add = [&](const Vec3& n) { return planes.add(to_dyadic(n), Dyadic(unit(random))); };
    Side f = add(first), q = add(second), r = add(third);
    if (planes.exact_meet(f, q, r).denominator.sign() < 0) std::swap(f, q);
    const PlaneSet::Point found = planes.meet(f, q, r);
    const PlaneSet::ExactPoint exact = planes.exact_meet(f, q, r);
    ASSERT_GT(exact.denominator.sign(), 0);
    const Dyadic3 x = to_dyadic(found.x);
    const Dyadic room = Dyadic(found.error) * exact.denominator;
    for (Dyadic off : {x.x * exact.denominator - exact.numerator.x, x.y * exact.denominator - exact.numerator.y,
                       x.z * exact.denominator - exact.numerator.z}) {
      if (off.sign() < 0) off = Dyadic(0.0) - off;
      EXPECT_LE((off - room).sign(), 0);
    }
    exactly += found.error <= 0x1p-51 * found.x.cwiseAbs().maxCoeff() ? 1 : 0;
  }
  EXPECT_GT(exactly, 200);
  EXPECT_LT(exactly, 1980);
}

}  // namespace
}  // namespace pd::detail
