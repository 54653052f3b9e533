/// @file
/// Swept bodies against the exact oracle of their cores: the signed distance of the cores less the two margins,
/// compared as exact numbers.

#include <gtest/gtest.h>

#include "oracle/judged_pair.hpp"

namespace pd {
namespace {

using oracle::JudgedPair;
using oracle::Scaled;
using scenes::DepthClass;
using scenes::PairFamily;

/// Sign of (x - signed depth of the swept bodies) for the cores' exact verdict and the sum of the margins.
int compare(double x, const oracle::Verdict& core, const Scaled& margins) {
  const Scaled rest = oracle::to_scaled(x) - margins;  // x - depth = rest - core's signed depth
  if (core.contact == ContactClass::overlapping) {
    return rest.mantissa.sign() < 0 ? -1 : core.depth.compare(rest);
  }
  // Minus the distance: rest + distance.
  if (core.contact == ContactClass::touching) return rest.mantissa.sign();
  return rest.mantissa.sign() >= 0 ? 1 : -core.distance.compare(-rest);
}

TEST(Rounded, BracketsHoldTheCoresDepthAndTheMargins) {
  Scratch scratch;
  int classes[3] = {};
  for (int f = 0; f < scenes::kPairFamilies; ++f) {
    const auto family = static_cast<PairFamily>(f);
    if (family == PairFamily::scales) continue;
    for (int d = 0; d < scenes::kDepthClasses; ++d) {
      for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        const JudgedPair pair = JudgedPair::of_family(family, 8, static_cast<DepthClass>(d), seed);
        SCOPED_TRACE(pair.name());
        const double extent = pair.extent();
        scenes::Random random(seed);
        const double margin_a = extent * random.uniform(0, 0.02);
        const double margin_b = seed % 2 == 0 ? 0 : extent * random.uniform(0, 0.02);
        const auto a = pair.a().shape->with_margin(margin_a);
        const auto b = pair.b().shape->with_margin(margin_b);
        ASSERT_TRUE(a && b);
        const PenetrationDepth answer = penetration_depth({&*a, pair.a().pose}, {&*b, pair.b().pose}, scratch);
        const Scaled margins = oracle::to_scaled(margin_a) + oracle::to_scaled(margin_b);
        const int sign = -compare(0, pair.verdict(), margins);  // of the swept bodies' signed depth
        const ContactClass expected = sign > 0   ? ContactClass::overlapping
                                      : sign < 0 ? ContactClass::separated
                                                 : ContactClass::touching;
        ++classes[static_cast<int>(expected)];
        ASSERT_EQ(answer.contact, expected);
        const double allowed = 4e-15 * (extent + margin_a + margin_b);
        if (sign > 0) {
          EXPECT_LE(compare(answer.lower, pair.verdict(), margins), 0);
          EXPECT_GE(compare(answer.upper, pair.verdict(), margins), 0);
          EXPECT_LE(answer.upper - answer.lower, allowed);
        } else if (sign < 0) {
          EXPECT_GE(compare(-answer.distance_lower, pair.verdict(), margins), 0);
          EXPECT_LE(compare(-answer.distance_upper, pair.verdict(), margins), 0);
          EXPECT_LE(answer.distance_upper - answer.distance_lower, allowed);
        }
        EXPECT_NEAR(answer.normal.norm(), 1, 1e-15);
        const double world = std::max(answer.witness_a.norm(), answer.witness_b.norm());
        const Vec3 expected_gap = sign < 0 ? Vec3(-answer.distance * answer.normal) : answer.translation;
        EXPECT_LE((answer.witness_b - answer.witness_a - expected_gap).cwiseAbs().maxCoeff(),
                  4e-15 * extent + 4 * 0x1p-52 * world);
      }
    }
  }
  std::printf("%d separated, %d touching, %d overlapping\n", classes[0], classes[1], classes[2]);
}

}  // namespace
}  // namespace pd
