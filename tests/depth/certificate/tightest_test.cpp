/// @file
/// Tightest brackets: decided in double-double for bodies in general position, and right where the nearest simplex
/// shares no vertex.

#include <gtest/gtest.h>

#include "oracle/judged_pair.hpp"

namespace pd {
namespace {

using oracle::JudgedPair;
using scenes::DepthClass;
using scenes::PairFamily;

TEST(Tightest, TakesNoExactSignInGeneralPosition) {
  Scratch scratch;
  for (const DepthClass depth : {DepthClass::shallow, DepthClass::mid, DepthClass::deep}) {
    for (const int n : {8, 32}) {
      for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        const JudgedPair pair = JudgedPair::of_family(PairFamily::sphere, n, depth, seed);
        const PenetrationDepth answer = penetration_depth(pair.a(), pair.b(), scratch);
        const std::string complaint = pair.complaint(answer, Bracket::tightest);
        EXPECT_TRUE(complaint.empty()) << complaint;
        // The finishing step counts as one.
        EXPECT_LE(answer.statistics.exact_signs, 1) << pair.name();
      }
    }
  }
}

/// Of the two ends of a nearest segment, or the corners of a nearest triangle, none need share a vertex of a body: then
/// that they are equally near in P says nothing about either body alone.
TEST(Tightest, NearestSimplicesWithoutASharedVertex) {
  Scratch scratch;
  for (const PairFamily family : {PairFamily::mixed_scales, PairFamily::near_kissing, PairFamily::parallel_edges}) {
    for (std::uint64_t seed = 100; seed < 160; ++seed) {
      const JudgedPair pair = JudgedPair::of_family(family, 8, DepthClass::shallow, seed);
      const PenetrationDepth answer = penetration_depth(pair.a(), pair.b(), scratch);
      const std::string complaint = pair.complaint(answer, Bracket::tightest);
      EXPECT_TRUE(complaint.empty()) << complaint;
    }
  }
  const JudgedPair found = JudgedPair::of_family(PairFamily::mixed_scales, 8, DepthClass::shallow, 41000005588);
  const std::string complaint = found.complaint(penetration_depth(found.a(), found.b(), scratch), Bracket::tightest);
  EXPECT_TRUE(complaint.empty()) << complaint;
}

}  // namespace
}  // namespace pd
