/// @file
/// "Apart by more than x?": early answers are certified and say what the full query says, near ones are the full query.

#include <gtest/gtest.h>

#include <cmath>

#include "oracle/curved_oracle.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "pd/depth/warm_certificate.hpp"
#include "scenes/shape_families.hpp"

namespace pd {
namespace {

using scenes::Random;

constexpr DepthSettings kCertified{.bracket = Bracket::certified};

DepthSettings beyond(double length) {
  DepthSettings settings = kCertified;
  settings.beyond = length;
  return settings;
}

struct Pair {
  ConvexShape a;
  ConvexShape b;
};
ConvexShape hull(int n, Random& random) { return *ConvexPolytope::from_points(scenes::sphere_hull(n, random)); }
Pair pair_of(int kind, Random& random) {
  switch (kind) {
    case 0:
      return {*ConvexPolytope::box({0.3, 0.5, 0.7}), *ConvexPolytope::box({0.6, 0.2, 0.4})};
    case 1:
      return {hull(8, random), hull(8, random)};
    case 2:
      return {hull(128, random), *hull(16, random).with_margin(0.1)};
    case 3:
      return {*ConvexShape::capsule(0.3, 0.5, 1), *ConvexShape::sphere(0.4)};
    case 4:
      return {*ConvexShape::cylinder(0.3, 0.5, 1), hull(32, random)};
    case 5:
      return {*ConvexShape::ellipsoid({0.3, 0.5, 0.9}), *ConvexShape::cone(0.4, 0.5, 0)->with_margin(0.05)};
    default:
      return {hull(600, random), hull(300, random)};
  }
}

/// Every number that an answer promises; the plane across the normal is asked of the shapes anew.
void expect_certified(const PosedShape& a, const PosedShape& b, const PenetrationDepth& early,
                      const PenetrationDepth& full) {
  ASSERT_EQ(early.contact, ContactClass::separated);
  EXPECT_NEAR(early.normal.norm(), 1, 1e-15);
  EXPECT_LE(early.distance_lower, full.distance_upper);
  EXPECT_GE(early.distance_upper, full.distance_lower);
  EXPECT_LE(early.distance_lower, early.distance);
  EXPECT_LE(early.distance, early.distance_upper);
  // The oracle sums in the place of the bodies, in extended precision.
  const double place = 0x1p-61 * a.pose.translation().norm();
  EXPECT_LE(static_cast<double>(oracle::difference_support(a, b, early.normal)), -early.distance_lower + place);
  // Far from the origin a witness keeps fewer bits of itself.
  const double rounding = 1e-13 + 1e-15 * a.pose.translation().norm();
  EXPECT_NEAR((early.witness_a - early.witness_b).norm(), early.distance, rounding);
  // The witnesses are points of the bodies: no farther out than these reach.
  for (const Vec3& n : {early.normal, Vec3(-early.normal), Vec3(Vec3::UnitX()), Vec3(Vec3::UnitY())}) {
    const Vec3 between = early.witness_b - early.witness_a;
    EXPECT_LE(between.dot(n), static_cast<double>(oracle::difference_support(a, b, n)) + rounding);
  }
}

TEST(Beyond, EarlyAnswersAreCertifiedAndNearOnesTheFullQuery) {
  Random random(41);
  Scratch scratch;
  int early = 0, asked = 0;
  for (int i = 0; i < 700; ++i) {
    const Pair pair = pair_of(i % 7, random);
    // Of a world's size, too.
    const Vec3 place = i % 3 == 0 ? Vec3(1e6, -2e6, 3e6) : Vec3(0.1, 0.2, 0.3);
    const PosedShape a{&pair.a, random.pose(place)};
    const PosedShape b{&pair.b, random.pose(place + random.vector(0.2, 4))};
    SCOPED_TRACE(i);
    const PenetrationDepth full = penetration_depth(a, b, scratch, kCertified);
    const double distance = full.distance_lower;
    for (const double share : {0.0, 0.3, 0.9, 1.0, 1.5}) {
      const double least = share * (distance > 0 ? (share < 1 ? distance : full.distance_upper) : 1);
      const PenetrationDepth answer = penetration_depth(a, b, scratch, beyond(least));
      if (full.contact != ContactClass::separated || share >= 1) {
        // Nothing may be shown there, so it is the full query, bit for bit.
        EXPECT_EQ(answer.contact, full.contact);
        EXPECT_EQ(answer.depth, full.depth);
        EXPECT_EQ(answer.distance, full.distance);
        EXPECT_EQ(answer.normal, full.normal);
        EXPECT_EQ(answer.witness_a, full.witness_a);
        continue;
      }
      ++asked;
      expect_certified(a, b, answer, full);
      EXPECT_GT(answer.distance_lower, least);
      if (answer.statistics.support_calls <= 12) ++early;
      const PenetrationDepth swapped = penetration_depth(b, a, scratch, beyond(least));
      EXPECT_EQ(swapped.normal, Vec3(-answer.normal));
      EXPECT_EQ(swapped.distance_lower, answer.distance_lower);
      EXPECT_EQ(swapped.witness_a, answer.witness_b);
    }
  }
  std::printf("%d of %d in few supports\n", early, asked);
  EXPECT_GT(asked, 600);
  EXPECT_GE(early, asked * 95 / 100);
}

/// A host's matrix may be a rotation up to single precision only: its body reaches farther than its radius.
TEST(Beyond, BallsHoldBodiesOfMatricesThatStretch) {
  Random random(47);
  Scratch scratch;
  int far = 0;
  for (int i = 0; i < 400; ++i) {
    SCOPED_TRACE(i);
    const Pair pair{hull(32, random), hull(32, random)};
    const double stretch = 1 + (i % 2 == 0 ? 0x1p-20 : 0x1p-12) * random.uniform();
    const auto pose = [&](const Vec3& at) {
      return Pose::from_trusted_matrix(stretch * Pose::from_quaternion(random.quaternion(), at)->rotation(), at);
    };
    const Vec3 way = random.vector(2.9, 3.2);
    const PosedShape a{&pair.a, pose(Vec3::Zero())}, b{&pair.b, pose(way)};
    const PenetrationDepth answer = penetration_depth(a, b, scratch, beyond(1));
    const PenetrationDepth full = penetration_depth(a, b, scratch, kCertified);
    ASSERT_EQ(answer.contact, ContactClass::separated);
    far += answer.statistics.support_calls == 0 ? 1 : 0;
    if (answer.distance_lower > 1) expect_certified(a, b, answer, full);
    // Both ways round.
    const PenetrationDepth back = penetration_depth(b, a, scratch, beyond(1));
    EXPECT_EQ(answer.distance_lower, back.distance_lower);
    EXPECT_EQ(answer.normal, -back.normal);
    EXPECT_EQ(answer.witness_a, back.witness_b);
  }
  EXPECT_GT(far, 50);
}

/// A body that drifts by: none or one support a frame while it is far, the full query when it comes near.
TEST(Beyond, WarmFramesTakeOneSupport) {
  Random random(43);
  Scratch scratch;
  int single = 0, none = 0, frames = 0;
  for (int kind = 0; kind < 7; ++kind) {
    const Pair pair = pair_of(kind, random);
    WarmCertificate memory;
    for (int frame = 0; frame < 200; ++frame) {
      const auto [sine, cosine] = scenes::turn(0.01 * frame);
      const PosedShape a{&pair.a, *Pose::from_quaternion({cosine, 0, sine, 0}, {0.001 * frame, 0, 0})};
      const PosedShape b{&pair.b, *Pose::from_quaternion({1, 0, 0, 0}, {0.4, 2.6 - 0.01 * frame, 0.1})};
      SCOPED_TRACE(kind * 1000 + frame);
      const PenetrationDepth answer = penetration_depth(a, b, scratch, beyond(0.05), &memory);
      const PenetrationDepth full = penetration_depth(a, b, scratch, kCertified);
      ASSERT_EQ(answer.contact, full.contact);
      if (full.contact != ContactClass::separated) continue;
      if (answer.distance_lower > 0.05) {
        expect_certified(a, b, answer, full);
        ++frames;
        single += answer.warm && answer.statistics.support_calls == 1 ? 1 : 0;
        none += answer.statistics.support_calls == 0 ? 1 : 0;
      } else {
        EXPECT_NEAR(answer.distance, full.distance, 1e-6 * full.distance);
      }
    }
  }
  std::printf("%d of %d frames with one support, %d with none\n", single, frames, none);
  EXPECT_GT(frames, 500);
  EXPECT_GE(single + none, frames * 95 / 100);
  EXPECT_GT(single, 300);
  EXPECT_GT(none, 300);
}

}  // namespace
}  // namespace pd
