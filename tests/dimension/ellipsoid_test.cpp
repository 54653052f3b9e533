// Sandwiches: what they promise is checked on the points themselves and on their extents.

#include <gtest/gtest.h>

#include "dimension/families.hpp"
#include "pd/dimension/enclosing_ellipsoid.hpp"

namespace pd::dimension {
namespace {

using namespace test;

template <int D>
void check_sandwich(std::span<const Vector<D>> points, const Sandwich<D>& sandwich, Random& random) {
  const AffineMap<D> fat = sandwich.fattening();
  for (const Vector<D>& p : points) {
    ASSERT_LE((fat.linear * (p - sandwich.centre)).norm(), sandwich.ratio * (1 + 1e-9));
  }
  // C in K: every support of K about the centre is at least that of the ellipsoid.
  for (int i = 0; i < 50; ++i) {
    const Vector<D> v = fat.linear.transpose() * random_direction<D>(random);
    double support = -INFINITY;
    for (const Vector<D>& p : points) support = std::max(support, v.dot(p - sandwich.centre));
    ASSERT_GE(support, (sandwich.axes.transpose() * v).norm() * (1 - 1e-9));
  }
}

template <int D>
void all_families(double eta) {
  Random random(7 + D);
  for (int family = 0; family < kFamilies; ++family) {
    SCOPED_TRACE(family_name(family) + " d = " + std::to_string(D));
    const std::vector<Vector<D>> points = family_points<D>(family, 200, random);
    const auto ellipsoid = enclosing_ellipsoid<D>(points, eta);
    ASSERT_TRUE(ellipsoid) << ellipsoid.error().message;
    EXPECT_LE(ellipsoid->sandwich.ratio, D * (1 + eta) * (1 + 1e-6));
    EXPECT_GE(ellipsoid->sandwich.ratio, 1);
    check_sandwich<D>(points, ellipsoid->sandwich, random);
  }
}

TEST(EnclosingEllipsoid, KeepsItsRatioOnEveryFamily) {
  all_families<2>(1e-2);
  all_families<3>(1e-2);
  all_families<4>(1e-2);
  all_families<5>(1e-1);
}

TEST(EnclosingEllipsoid, OfASimplexIsJohnsOwn) {
  // The minimum ellipsoid of a simplex passes through all vertices; its centre is the centroid, its ratio exactly d.
  const std::vector<Vector<3>> points = {Vector<3>(0, 0, 0), Vector<3>(1, 0, 0), Vector<3>(0, 1, 0),
                                         Vector<3>(0, 0, 1)};
  const auto e = enclosing_ellipsoid<3>(points, 1e-6);
  ASSERT_TRUE(e);
  EXPECT_NEAR((e->sandwich.centre - Vector<3>::Constant(0.25)).norm(), 0, 1e-5);
  EXPECT_NEAR(e->sandwich.ratio, 3, 1e-5);
}

TEST(EnclosingEllipsoid, RefusesByName) {
  using P = Vector<3>;
  const std::vector<P> flat = {P(0, 0, 1), P(1, 0, 1), P(0, 1, 1), P(1, 1, 1), P(2, 3, 1)};
  EXPECT_EQ(enclosing_ellipsoid<3>(flat, 0.1).error().code, ErrorCode::not_full_dimensional);
  EXPECT_EQ(enclosing_ellipsoid<3>(std::vector<P>(3, P(0, 0, 1)), 0.1).error().code, ErrorCode::too_few_points);
  EXPECT_EQ(enclosing_ellipsoid<3>(flat, 0).error().code, ErrorCode::bad_value);
  EXPECT_EQ(enclosing_ellipsoid<3>(flat, 1.5).error().code, ErrorCode::bad_value);
  std::vector<P> broken = flat;
  broken[3][1] = NAN;
  EXPECT_EQ(enclosing_ellipsoid<3>(broken, 0.1).error().where, "points[3]");
  broken[3][1] = 1e200;
  EXPECT_EQ(enclosing_ellipsoid<3>(broken, 0.1).error().code, ErrorCode::out_of_range);
}

template <int D>
void check_sum_fattening() {
  Random random(99 + D);
  for (int trial = 0; trial < 20; ++trial) {
    std::vector<std::vector<Vector<D>>> summands;
    std::vector<SandwichBox<D>> boxes;
    for (int i = 0; i < 1 + trial % 3; ++i) {
      std::vector<Vector<D>> points = family_points<D>((trial + 2 * i) % kFamilies, 60, random);
      const auto ellipsoid = enclosing_ellipsoid<D>(points, 0.1);
      ASSERT_TRUE(ellipsoid);
      // Lemma 7: the box itself is a sandwich of ratio d^(3/2) (1 + eta).
      const SandwichBox<D> box = sandwich_box(ellipsoid->sandwich);
      EXPECT_LE(box.ratio, std::pow(D, 1.5) * 1.11);
      const Matrix<D> inverse = inverse_of<D>(box.axes);
      for (const Vector<D>& p : points) {
        ASSERT_LE((inverse * (p - box.centre)).cwiseAbs().maxCoeff(), box.ratio * (1 + 1e-6));
      }
      const AffineMap<D> map{random_stretch<D>(random, trial % 2 == 0 ? 1 : 1e3), random_direction<D>(random)};
      for (Vector<D>& p : points) p = map.apply(p);
      boxes.push_back(box.mapped(map));
      summands.push_back(points);
    }
    const FatteningMap<D> fat = fatten_sum<D>(boxes);
    // Lemma 10: gamma = 1 / d^2.
    EXPECT_LE(fat.outer_radius, D * D * 1.11);
    for (int i = 0; i < 40; ++i) {
      const Vector<D> u = random_direction<D>(random);
      const Vector<D> v = fat.map.linear.transpose() * u;
      double support = u.dot(fat.map.translation);
      for (const auto& points : summands) support += scanned_support<D>(points, v);
      ASSERT_GE(support, 1 - 1e-6);
      ASSERT_LE(support, fat.outer_radius * (1 + 1e-6));
    }
  }
}

TEST(FattenSum, HoldsLemma10ForAffineImagesOfOneToThreeBodies) {
  check_sum_fattening<2>();
  check_sum_fattening<3>();
  check_sum_fattening<4>();
  check_sum_fattening<5>();
}

TEST(EnclosingEllipsoid, EndsWithTheLeastEta) {
  const std::vector<Vector<2>> points{Vector<2>(0, 0), Vector<2>(1, 0), Vector<2>(0, 1), Vector<2>(3, 2)};
  const auto ellipsoid = enclosing_ellipsoid<2>(points, 1e-7);
  ASSERT_TRUE(ellipsoid);
  EXPECT_LE(ellipsoid->sandwich.ratio, 2 * (1 + 1e-7));
  for (const double eta : {0.99e-7, 1e-12, 1e-300}) {
    const auto refused = enclosing_ellipsoid<2>(points, eta);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().where, "eta");
  }
}

}  // namespace
}  // namespace pd::dimension
