/// Exact orientation tests: the sign, and which of the three stages decided it.
#include "pd/numeric/predicates.hpp"

#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <random>

namespace pd {
namespace {

using Rational = boost::multiprecision::cpp_rational;
using Point2 = std::array<double, 2>;

/// The same determinants in rationals, sharing nothing with the library.
int rational_orient2d(const Point2& a, const Point2& b, const Point2& c) {
  const Rational d = (Rational(b[0]) - Rational(a[0])) * (Rational(c[1]) - Rational(a[1])) -
                     (Rational(b[1]) - Rational(a[1])) * (Rational(c[0]) - Rational(a[0]));
  return d.sign();
}

int rational_orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  Rational m[3][3];
  for (int i = 0; i < 3; ++i) {
    m[0][i] = Rational(b[i]) - Rational(a[i]);
    m[1][i] = Rational(c[i]) - Rational(a[i]);
    m[2][i] = Rational(d[i]) - Rational(a[i]);
  }
  const Rational determinant = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                               m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                               m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
  return determinant.sign();
}

TEST(Predicates, SignConvention) {
  EXPECT_EQ(orient2d({0, 0}, {1, 0}, {0, 1}), 1);
  EXPECT_EQ(orient2d({0, 0}, {0, 1}, {1, 0}), -1);
  const Vec3 o(0, 0, 0);
  EXPECT_EQ(orient3d(o, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}), 1);
  EXPECT_EQ(orient3d(o, {1, 0, 0}, {0, 1, 0}, {0, 0, -1}), -1);
  EXPECT_EQ(orient3d(o, {1, 0, 0}, {0, 1, 0}, {5, 7, 0}), 0);
}

TEST(Predicates, FilterDecidesPlainInput) {
  PredicateStages stages;
  EXPECT_EQ(orient2d({0, 0}, {1, 0.25}, {0.5, 3}, &stages), 1);
  EXPECT_EQ(orient3d({0, 0, 0}, {1, 0.5, 0}, {0, 1, 0.25}, {0.3, 0.2, 4}, &stages), 1);
  EXPECT_EQ(stages.filtered, 2);
  EXPECT_EQ(stages.double_double, 0);
  EXPECT_EQ(stages.expansion, 0);
  EXPECT_EQ(stages.dyadic, 0);
}

TEST(Predicates, DoubleDoubleDecidesNearMisses) {
  // Points of a rounded tilted plane: off it by an ulp or so, and never by less than double-double sees.
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> u(-1, 1);
  PredicateStages stages;
  for (int round = 0; round < 1000; ++round) {
    Vec3 p[4];
    for (Vec3& q : p) {
      q.x() = u(random);
      q.y() = u(random);
      q.z() = 0.3 * q.x() + 0.7 * q.y();
    }
    ASSERT_EQ(orient3d(p[0], p[1], p[2], p[3], &stages), rational_orient3d(p[0], p[1], p[2], p[3]));
  }
  EXPECT_GT(stages.double_double, 900);
  EXPECT_EQ(stages.dyadic, 0);
}

TEST(Predicates, ExpansionsDecideWhatRoundingHides) {
  PredicateStages stages;
  // 0.1 + 0.2 is one ulp above 0.3: the three points are not quite on the diagonal.
  EXPECT_EQ(orient2d({0, 0}, {0.3, 0.3}, {0.1 + 0.2, std::nextafter(0.1 + 0.2, 1)}, &stages), 1);
  EXPECT_EQ(orient2d({0, 0}, {0.3, 0.3}, {0.7, 0.7}, &stages), 0);
  const double high = std::nextafter(1.0, 2);
  EXPECT_EQ(orient3d({0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {0.3, 0.3, high}, &stages), 1);
  EXPECT_EQ(orient3d({0.1, 0.2, 0.3}, {0.2, 0.4, 0.6}, {0.7, 0.1, 0.4}, {0.3, 0.6, 0.1 + 0.8}, &stages),
            rational_orient3d({0.1, 0.2, 0.3}, {0.2, 0.4, 0.6}, {0.7, 0.1, 0.4}, {0.3, 0.6, 0.1 + 0.8}));
  // Exactly on a plane: only exact arithmetic can say so.
  EXPECT_EQ(orient3d({0.1, 0.2, 0.3}, {0.3, 0.1, 0.7}, {0.5, 0.9, 0.2}, {0.1, 0.2, 0.3}, &stages), 0);
  EXPECT_EQ(stages.expansion, 3);
  EXPECT_EQ(stages.double_double, 1);
  EXPECT_EQ(stages.filtered, 1);
  EXPECT_EQ(stages.dyadic, 0);
}

TEST(Predicates, DyadicNumbersDecideBeyondTheRangeOfProducts) {
  PredicateStages stages;
  EXPECT_EQ(orient2d({0, 0}, {1e-300, 0}, {0, 1e-300}, &stages), 1);
  EXPECT_EQ(orient2d({0, 0}, {1e300, 1e300}, {1e300, std::nextafter(1e300, 2e300)}, &stages), 1);
  EXPECT_EQ(orient3d({0, 0, 0}, {1e-200, 0, 0}, {0, 1e-200, 0}, {0, 0, 1e-200}, &stages), 1);
  EXPECT_EQ(orient3d({0, 0, 0}, {1e300, 0, 0}, {0, 1e300, 0}, {0, 0, -1e300}, &stages), -1);
  EXPECT_EQ(orient3d({0, 0, 0}, {1e300, 0, 0}, {0, 1e300, 0}, {1e300, 1e300, 5e-324}, &stages), 1);
  EXPECT_EQ(orient3d({0, 0, 0}, {5e-324, 0, 0}, {0, 5e-324, 0}, {0, 0, 5e-324}, &stages), 1);
  EXPECT_EQ(stages.dyadic, 6);
  EXPECT_EQ(stages.expansion, 0);
  EXPECT_EQ(stages.filtered, 0);
}

TEST(Predicates, AgreeWithRationalsNearDegeneracy) {
  std::mt19937_64 random(20240611);
  std::uniform_int_distribution<int> small(-8, 8);
  std::uniform_int_distribution<int> ulps(-2, 2);
  std::uniform_int_distribution<int> exponent(-40, 40);
  const auto nudge = [&](double v) {
    for (int k = ulps(random); k != 0; k += k > 0 ? -1 : 1) v = std::nextafter(v, k > 0 ? 1e308 : -1e308);
    return v;
  };
  PredicateStages stages;
  for (int round = 0; round < 20000; ++round) {
    // Four points of a plane with small integer directions, scaled, shifted, and each coordinate nudged by a few ulp.
    const double about_one = 1.0 + 0.1 * small(random);
    const double scale = std::ldexp(about_one, exponent(random));
    const Vec3 u = Eigen::Vector3i{small(random), small(random), small(random)}.cast<double>();
    const Vec3 v = Eigen::Vector3i{small(random), small(random), small(random)}.cast<double>();
    const Vec3 shift{0.1 * small(random), 0.3 * small(random), 0.7 * small(random)};
    Vec3 p[4];
    for (Vec3& q : p) {
      const double along_u = small(random), along_v = small(random);
      q = (shift + along_u * u + along_v * v) * scale;
      for (int i = 0; i < 3; ++i) q[i] = nudge(q[i]);
    }
    ASSERT_EQ(orient3d(p[0], p[1], p[2], p[3], &stages), rational_orient3d(p[0], p[1], p[2], p[3]));
    ASSERT_EQ(orient2d({p[0][0], p[0][1]}, {p[1][0], p[1][1]}, {p[2][0], p[2][1]}, &stages),
              rational_orient2d({p[0][0], p[0][1]}, {p[1][0], p[1][1]}, {p[2][0], p[2][1]}));
  }
  EXPECT_GT(stages.expansion, 300);
  EXPECT_GT(stages.double_double, 300);
  EXPECT_GT(stages.filtered, 1000);
}

TEST(Predicates, AgreeWithRationalsAtAnyMagnitude) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> fraction(-1, 1);
  std::uniform_int_distribution<int> exponent(-1070, 990);
  PredicateStages stages;
  for (int round = 0; round < 500; ++round) {
    Vec3 p[4];
    for (Vec3& q : p) {
      for (int i = 0; i < 3; ++i) {
        const double part = fraction(random);
        q[i] = std::ldexp(part, exponent(random));
      }
    }
    ASSERT_EQ(orient3d(p[0], p[1], p[2], p[3], &stages), rational_orient3d(p[0], p[1], p[2], p[3]));
    ASSERT_EQ(orient2d({p[0][0], p[0][1]}, {p[1][0], p[1][1]}, {p[2][0], p[2][1]}, &stages),
              rational_orient2d({p[0][0], p[0][1]}, {p[1][0], p[1][1]}, {p[2][0], p[2][1]}));
  }
  EXPECT_GT(stages.dyadic, 300);
}

TEST(Predicates, PermutationsTurnTheSign) {
  const Vec3 a(0.1, 0.7, -0.3);
  const Vec3 b(0.4, 0.2, 0.9);
  const Vec3 c(-0.5, 0.6, 0.8);
  const Vec3 d = a + (b - a) + (c - a);  // coplanar but for rounding
  const int sign = orient3d(a, b, c, d);
  EXPECT_EQ(orient3d(b, a, c, d), -sign);
  EXPECT_EQ(orient3d(b, c, a, d), sign);
  EXPECT_EQ(orient3d(d, b, c, a), -sign);
}

/// Four points that are coplanar but for rounding.
std::array<Vec3, 4> nearly_coplanar(std::mt19937_64& random) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto point = [&] { return Vec3{uniform(random), uniform(random), uniform(random)}; };
  const Vec3 a = point(), b = point(), c = point();
  const double along_b = uniform(random), along_c = uniform(random);
  return {a, b, c, a + along_b * (b - a) + along_c * (c - a)};
}

TEST(Predicates, CyclesKeepTheSign) {
  std::mt19937_64 random(5);
  int nonzero = 0;
  for (int i = 0; i < 1000; ++i) {
    const auto [a, b, c, d] = nearly_coplanar(random);
    const int sign = orient3d(a, b, c, d);
    nonzero += sign != 0;
    EXPECT_EQ(orient3d(b, c, a, d), sign);
    EXPECT_EQ(orient3d(c, a, b, d), sign);
    EXPECT_EQ(orient3d(b, c, d, a), -sign);
    EXPECT_EQ(orient3d(c, d, a, b), sign);
    const auto flat = [](const Vec3& p) { return std::array<double, 2>{p.x(), p.y()}; };
    const std::array<double, 2> p = flat(a), q = flat(b), r = flat(0.5 * (a + b));  // collinear but for rounding
    EXPECT_EQ(orient2d(q, r, p), orient2d(p, q, r));
    EXPECT_EQ(orient2d(r, p, q), orient2d(p, q, r));
    EXPECT_EQ(orient2d(q, p, r), -orient2d(p, q, r));
  }
  EXPECT_GT(nonzero, 500);
}

TEST(Predicates, PowersOfTwoKeepTheSign) {
  std::mt19937_64 random(6);
  for (int i = 0; i < 1000; ++i) {
    const auto [a, b, c, d] = nearly_coplanar(random);
    for (const double scale : {0x1p-900, 0x1p-300, 0x1p60, 0x1p1000}) {
      EXPECT_EQ(orient3d(scale * a, scale * b, scale * c, scale * d), orient3d(a, b, c, d));
    }
  }
}

TEST(Predicates, Incidence) {
  const Vec3 p(0.1, 0.7, -0.3), q(0.4, 0.2, 0.9), r(-0.5, 0.6, 0.8);
  for (const auto& [a, b, c, d] :
       {std::array{p, p, q, r}, std::array{p, q, p, r}, std::array{p, q, r, p}, std::array{q, p, r, r}}) {
    EXPECT_EQ(orient3d(a, b, c, d), 0);
  }
  EXPECT_EQ(orient2d({0.1, 0.7}, {0.1, 0.7}, {0.3, 0.2}), 0);

  EXPECT_TRUE(collinear({0, 0, 0}, {0.1, 0.2, 0.3}, {0.2, 0.4, 0.6}));
  EXPECT_FALSE(collinear({0, 0, 0}, {0.1, 0.2, 0.3}, {0.2, 0.4, std::nextafter(0.6, 1)}));
  EXPECT_TRUE(collinear({1, 2, 3}, {1, 2, 3}, {4, 5, 6}));
  EXPECT_TRUE(collinear({0, 0, 5}, {0, 0, 6}, {0, 0, 9}));
  EXPECT_TRUE(coplanar({0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {0.3, 0.7, 1}));
  EXPECT_FALSE(coplanar({0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {0.3, 0.7, std::nextafter(1.0, 2)}));
}

}  // namespace
}  // namespace pd
