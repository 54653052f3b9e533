/// @file
/// Local minima of the height of curved bodies: no height in their cone is below the bound (in long double), the
/// features that meet in closed form, and what they spare a search.

#include "depth/features/local_minimum.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "oracle/curved_oracle.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "scenes/shape_families.hpp"

namespace pd::detail {
namespace {

using scenes::Random;

/// Cores without margins, thin ones among them.
ConvexShape random_core(int kind, Random& random) {
  const auto size = [&] { return random.integer(0, 3) == 0 ? random.uniform(0.02, 0.2) : random.uniform(0.4, 1.2); };
  struct Axial {
    int axis;
    double half_height;
    double radius;
  };
  const auto axial = [&] { return Axial{random.integer(0, 2), size(), size()}; };
  switch (kind) {
    case 0: {
      const Axial sizes = axial();
      return *ConvexShape::cylinder(sizes.radius, sizes.half_height, sizes.axis);
    }
    case 1: {
      const Axial sizes = axial();
      return *ConvexShape::cone(sizes.radius, sizes.half_height, sizes.axis);
    }
    case 2: {
      const auto centre = [&] {
        const Vec3 unit = random.direction();
        return Vec3(size() * unit);
      };
      return *ConvexShape::hull_of_spheres(
          std::vector<Sphere>{{centre(), size()}, {centre(), size()}, {Vec3::Zero(), 0.0}});
    }
    default:
      return *ConvexPolytope::box({size(), size(), size()});
  }
}

/// Unit, at most `angle` from another one, often at just that.
Vec3 near_direction(const Vec3& axis, double angle, Random& random) {
  const Vec3 across = axis.cross(random.direction()).normalized();
  const double turn = angle * (random.integer(0, 1) == 0 ? 1 : random.uniform(0, 1));
  return (std::cos(turn) * axis + std::sin(turn) * across).normalized();
}

TEST(LocalMinimum, NoHeightInTheConeIsLess) {
  Random random(4);
  Scratch scratch;
  int found = 0;
  double widest = 0;
  for (int i = 0; i < 4000; ++i) {
    const ConvexShape a = random_core(i % 4, random), b = random_core(random.integer(0, 3), random);
    const PosedShape posed_a{&a, random.pose(Vec3::Zero())};
    const PosedShape posed_b{&b, random.pose(0.8 * random.direction())};
    std::vector<PointPair> points;
    const SmoothDifference difference(posed_a, posed_b, points);
    // The least one, or one that may be found from anywhere.
    const PenetrationDepth least = penetration_depth(posed_a, posed_b, scratch, {.bracket = Bracket::tightest});
    const Vec3 normal = i % 3 == 0 ? random.direction() : near_direction(least.normal, 0.2, random);
    DifferenceVertex corners[3];
    for (DifferenceVertex& corner : corners) corner = difference.support(near_direction(normal, 0.3, random), nullptr);
    const auto minimum = local_minimum(difference, corners, normal, 1e-6);
    if (!minimum) continue;
    ++found;
    ASSERT_NEAR(minimum->normal.norm(), 1, 1e-15);
    // Of the cores: the oracle's bodies have their margins.
    const long double margin = static_cast<long double>(a.margin()) + b.margin();
    const long double own = oracle::difference_support(posed_a, posed_b, minimum->normal) - margin;
    ASSERT_LE(minimum->lower, own);
    ASSERT_GE(minimum->upper, own);
    ASSERT_LE(minimum->upper - minimum->lower, 1e-6 * minimum->upper + 1e-14);
    const double angle = std::acos(minimum->cosine);
    widest = std::max(widest, angle);
    for (int k = 0; k < 60; ++k) {
      const Vec3 direction = near_direction(minimum->normal, angle, random);
      ASSERT_GE(oracle::difference_support(posed_a, posed_b, direction) - margin, minimum->lower)
          << "pair " << i << ", kinds " << i % 4 << ", cosine " << minimum->cosine;
    }
    // The foot: a combination of points of both bodies, along the normal.
    Vec3 foot = Vec3::Zero();
    double sum = 0;
    for (int k = 0; k < 3; ++k) {
      ASSERT_GE(minimum->weights[k], 0);
      foot += minimum->weights[k] * minimum->corners[k].x;
      sum += minimum->weights[k];
    }
    ASSERT_NEAR(sum, 1, 1e-12);
    // Of two points it is off by what is left of Newton's method: the root of the bracket's width.
    ASSERT_LE((foot - foot.dot(minimum->normal) * minimum->normal).norm(), 2e-3);
  }
  EXPECT_GT(found, 400);
  EXPECT_GT(widest, 0.5);
}

TEST(LocalMinimum, ADiscOverACorner) {
  const ConvexShape cylinder = *ConvexShape::cylinder(1, 0.5, 2);
  const ConvexShape box = *ConvexPolytope::box({1, 1, 1});
  // A corner of the box points down into the disc, a quarter deep, off the axis.
  const Pose on_corner = *Pose::from_matrix(Mat3{{std::sqrt(0.5), -std::sqrt(0.5), 0},
                                                 {std::sqrt(1.0 / 6), std::sqrt(1.0 / 6), -std::sqrt(2.0 / 3)},
                                                 {std::sqrt(1.0 / 3), std::sqrt(1.0 / 3), std::sqrt(1.0 / 3)}},
                                            Vec3(0.3, -0.2, 0.25 + std::sqrt(3.0)));
  Scratch scratch;
  const PenetrationDepth answer = penetration_depth({&cylinder, *Pose::from_quaternion({1, 0, 0, 0}, Vec3::Zero())},
                                                    {&box, on_corner}, scratch, {.bracket = Bracket::tightest});
  EXPECT_EQ(answer.contact, ContactClass::overlapping);
  EXPECT_NEAR(answer.depth, 0.25, 1e-13);
  EXPECT_LE(answer.upper - answer.lower, 1e-13);
  EXPECT_NEAR(answer.normal.z(), -1, 1e-12);
  EXPECT_LE((answer.witness_a - Vec3(0.3, -0.2, 0.5)).norm(), 1e-12);
  EXPECT_LE(answer.statistics.support_calls, 14);
}

/// Only the tightest bracket needs the minimum: its foot is known. Two cylinders took twice the time without.
TEST(LocalMinimum, SparesSearchesTheirHalving) {
  Random random(9);
  Scratch scratch;
  std::int64_t supports = 0, most = 0;
  int overlapping = 0;
  for (int i = 0; i < 400; ++i) {
    const double half_height = random.uniform(0.5, 1);
    const ConvexShape cylinder = *ConvexShape::cylinder(random.uniform(0.5, 1), half_height, 2);
    const double other_half_height = random.uniform(0.5, 1);
    const ConvexShape other = *ConvexShape::cylinder(random.uniform(0.5, 1), other_half_height, 2);
    const Pose a = random.pose(Vec3::Zero());
    const Pose b = random.pose(1.4 * random.direction());
    const PenetrationDepth answer =
        penetration_depth({&cylinder, a}, {&other, b}, scratch, {.bracket = Bracket::tightest});
    if (answer.contact != ContactClass::overlapping) continue;
    EXPECT_TRUE(answer.bracket_reached);
    ++overlapping;
    supports += answer.statistics.support_calls;
    most = std::max(most, answer.statistics.support_calls);
  }
  EXPECT_GT(overlapping, 150);
  EXPECT_LT(supports, 45 * overlapping);
  EXPECT_LT(most, 256);
}

}  // namespace
}  // namespace pd::detail
