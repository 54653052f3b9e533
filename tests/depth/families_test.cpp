/// @file
/// A sample of what `oracle_pairs` judges by the million: every family at every depth, by every exact engine.

#include <gtest/gtest.h>

#include "oracle/judged_pair.hpp"

namespace pd {
namespace {

using oracle::JudgedPair;
using scenes::DepthClass;
using scenes::PairFamily;

class Families : public testing::TestWithParam<int> {};

TEST_P(Families, EveryPromiseIsKept) {
  const auto family = static_cast<PairFamily>(GetParam());
  Scratch scratch;
  for (int d = 0; d < scenes::kDepthClasses; ++d) {
    for (const int n : {4, 6, 8, 13, 32}) {
      for (std::uint64_t seed = 1; seed <= (n < 32 ? 6 : 2); ++seed) {
        const JudgedPair pair = JudgedPair::of_family(family, n, static_cast<DepthClass>(d), seed);
        for (const Method method : {Method::automatic, Method::expansion, Method::overlay}) {
          const Bracket bracket = seed % 2 == 0 ? Bracket::tightest : Bracket::certified;
          const PenetrationDepth answer =
              penetration_depth(pair.a(), pair.b(), scratch, {.method = method, .bracket = bracket});
          {
            const std::string complaint = pair.complaint(answer, bracket);
            ASSERT_TRUE(complaint.empty()) << to_string(method) << " " << complaint;
          }
        }
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, Families, testing::Range(0, scenes::kPairFamilies), [](const auto& tested) {
  return std::string(to_string(static_cast<PairFamily>(tested.param)));
});

TEST(LargeBodies, KeepEveryPromise) {
  Scratch scratch;
  for (const PairFamily family : {PairFamily::sphere, PairFamily::needle, PairFamily::prism, PairFamily::grid,
                                  PairFamily::patch, PairFamily::roofs, PairFamily::tilted_roofs}) {
    for (const DepthClass depth : {DepthClass::shallow, DepthClass::deep}) {
      const JudgedPair pair = JudgedPair::of_family(family, 256, depth, 3);
      const PenetrationDepth answer = penetration_depth(pair.a(), pair.b(), scratch, {.bracket = Bracket::certified});
      {
        const std::string complaint = pair.complaint(answer, Bracket::certified);
        EXPECT_TRUE(complaint.empty()) << complaint;
      }
    }
  }
}

}  // namespace
}  // namespace pd
