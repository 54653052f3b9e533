/// @file
/// The hot path allocates nothing once its scratch has grown.

#include <gtest/gtest.h>

#include "depth/allocator.hpp"
#include "oracle/judged_pair.hpp"
#include "pd/depth/warm_certificate.hpp"

namespace pd {
namespace {

using oracle::JudgedPair;
using scenes::DepthClass;
using scenes::PairFamily;

TEST(Allocations, NoneAfterTheFirstCall) {
  const DepthSettings hot{.bracket = Bracket::certified};
  Scratch scratch;
  int exact = 0;
  int pairs = 0;
  for (int f = 0; f < scenes::kPairFamilies; ++f) {
    if (static_cast<PairFamily>(f) == PairFamily::scales) continue;  // sizes beyond 2^100 are copied to size 1
    for (int d = 0; d < scenes::kDepthClasses; ++d) {
      for (const int n : {8, 64}) {
        const JudgedPair pair = JudgedPair::of_family(static_cast<PairFamily>(f), n, static_cast<DepthClass>(d), 31);
        const PosedShape a = pair.a();
        const PosedShape b = pair.b();
        (void)penetration_depth(a, b, scratch, hot);
        const std::int64_t before = test::allocations();
        const PenetrationDepth answer = penetration_depth(a, b, scratch, hot);
        const std::int64_t after = test::allocations();
        ++pairs;
        // Numbers of unbounded length may allocate; the filter decides nearly always.
        if (answer.statistics.exact_signs > 0) {
          ++exact;
          continue;
        }
        EXPECT_EQ(after - before, 0) << pair.name();
      }
    }
  }
  std::printf("%d pairs, %d of them reached exact arithmetic\n", pairs, exact);
}

/// `Bracket::contact` has no exact arithmetic to fall back to, so that no call allocates.
TEST(Allocations, NoneForContacts) {
  Scratch scratch;
  for (int f = 0; f < scenes::kPairFamilies; ++f) {
    if (static_cast<PairFamily>(f) == PairFamily::scales) continue;  // as above
    for (int d = 0; d < scenes::kDepthClasses; ++d) {
      for (const int n : {8, 64}) {
        const JudgedPair pair = JudgedPair::of_family(static_cast<PairFamily>(f), n, static_cast<DepthClass>(d), 32);
        const PosedShape a = pair.a();
        const PosedShape b = pair.b();
        const DepthSettings settings{.bracket = Bracket::contact, .contact_tolerance = 0x1p-30};
        (void)penetration_depth(a, b, scratch, settings);
        const std::int64_t before = test::allocations();
        const PenetrationDepth answer = penetration_depth(a, b, scratch, settings);
        EXPECT_EQ(test::allocations() - before, 0) << pair.name();
        EXPECT_EQ(answer.statistics.exact_signs, 0) << pair.name();
      }
    }
  }
}

/// Directions that are not across a needle see but its two ends: the first simplex has to be looked for.
TEST(Allocations, NoneForNeedles) {
  Scratch scratch;
  int overlapping = 0;
  for (const DepthClass depth : {DepthClass::shallow, DepthClass::mid, DepthClass::deep}) {
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
      const scenes::PointPair points = scenes::make_pair(PairFamily::needle, 32, depth, seed);
      const ConvexShape a(*ConvexPolytope::from_points(points.a));
      const ConvexShape b(*ConvexPolytope::from_points(points.b));
      for (const Bracket bracket : {Bracket::certified, Bracket::tightest}) {
        const DepthSettings settings{.bracket = bracket};
        (void)penetration_depth({&a, points.pose_a}, {&b, points.pose_b}, scratch, settings);
        const std::int64_t before = test::allocations();
        const PenetrationDepth d = penetration_depth({&a, points.pose_a}, {&b, points.pose_b}, scratch, settings);
        overlapping += d.contact == ContactClass::overlapping;
        EXPECT_EQ(test::allocations() - before, 0) << scenes::to_string(depth) << ", seed " << seed;
      }
    }
  }
  EXPECT_GT(overlapping, 40);
}

TEST(Allocations, NoneWhenWarm) {
  Scratch scratch;
  WarmCertificate certificate;
  const JudgedPair pair = JudgedPair::of_family(PairFamily::sphere, 64, DepthClass::mid, 5);
  const PosedShape a = pair.a();
  PosedShape b = pair.b();
  const auto q = b.pose.quaternion_wxyz();
  (void)penetration_depth(a, b, scratch, {.bracket = Bracket::certified}, &certificate);
  (void)penetration_depth(a, b, scratch, {.bracket = Bracket::certified}, &certificate);
  std::int64_t counted_in_loop = 0;
  for (int k = 1; k <= 100; ++k) {
    b.pose = *Pose::from_quaternion(q, pair.b().pose.translation() + 1e-4 * k * Vec3(1, -1, 0.5));
    const std::int64_t before = test::allocations();
    (void)penetration_depth(a, b, scratch, {.bracket = Bracket::certified}, &certificate);
    if (k > 10) counted_in_loop += test::allocations() - before;
  }
  EXPECT_EQ(counted_in_loop, 0);
}

}  // namespace
}  // namespace pd
