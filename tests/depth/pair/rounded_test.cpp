/// @file
/// Swept bodies against the exact oracle of their cores: the signed distance of the cores less the two margins,
/// compared as exact numbers.

#include <gtest/gtest.h>

#include "oracle/resting_pair.hpp"

namespace pd {
namespace {

using oracle::JudgedPair;
using oracle::Scaled;
using scenes::DepthClass;
using scenes::PairFamily;

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
        const int sign = -oracle::compare_with_depth(0, pair.verdict(), margins);  // of the swept bodies' signed depth
        const ContactClass expected = sign > 0   ? ContactClass::overlapping
                                      : sign < 0 ? ContactClass::separated
                                                 : ContactClass::touching;
        ++classes[static_cast<int>(expected)];
        ASSERT_EQ(answer.contact, expected);
        const double allowed = 4e-15 * (extent + margin_a + margin_b);
        if (sign > 0) {
          EXPECT_LE(oracle::compare_with_depth(answer.lower, pair.verdict(), margins), 0);
          EXPECT_GE(oracle::compare_with_depth(answer.upper, pair.verdict(), margins), 0);
          EXPECT_LE(answer.upper - answer.lower, allowed);
        } else if (sign < 0) {
          EXPECT_GE(oracle::compare_with_depth(-answer.distance_lower, pair.verdict(), margins), 0);
          EXPECT_LE(oracle::compare_with_depth(-answer.distance_upper, pair.verdict(), margins), 0);
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

TEST(Rounded, AtRestWithinAHairOfContact) {
  Scratch scratch;
  int classes[3] = {};
  for (std::uint64_t seed = 1; seed <= 1500; ++seed) {
    const oracle::RestingPair rest = oracle::make_resting_pair(seed, scratch);
    const JudgedPair pair(rest.cores, "resting seed " + std::to_string(seed));
    const auto a = pair.a().shape->with_margin(rest.margin_a);
    const auto b = pair.b().shape->with_margin(rest.margin_b);
    for (const Bracket bracket : {Bracket::tightest, Bracket::certified}) {
      DepthSettings settings;
      settings.bracket = bracket;
      const PenetrationDepth answer = penetration_depth({&*a, pair.a().pose}, {&*b, pair.b().pose}, scratch, settings);
      ++classes[static_cast<int>(answer.contact)];
      EXPECT_EQ(oracle::check_rounded(pair, rest.margin_a, rest.margin_b, answer, bracket), "") << pair.name();
    }
  }
  std::printf("%d separated, %d touching, %d overlapping\n", classes[0], classes[1], classes[2]);
}

}  // namespace
}  // namespace pd
