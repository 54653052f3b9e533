/// @file
/// The shared hard cases through the main call: polytopes to the last promise, rounded and smooth bodies within the
/// case's tolerance; and the regressions of tests/corpus.

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "oracle/corpus.hpp"
#include "oracle/curved_oracle.hpp"
#include "oracle/judged_pair.hpp"

namespace pd {
namespace {

using oracle::PairText;

void judge_polytopes(const PairText& p, Scratch& scratch) {
  const scenes::PointPair points{p.shape_a.points, p.shape_b.points, make_pose(p.pose_a), make_pose(p.pose_b)};
  const oracle::JudgedPair pair(points, p.name);
  for (const Method method : {Method::automatic, Method::expansion, Method::overlay}) {
    for (const Bracket bracket : {Bracket::certified, Bracket::tightest}) {
      const PenetrationDepth answer =
          penetration_depth(pair.a(), pair.b(), scratch, {.method = method, .bracket = bracket});
      {
        const std::string complaint = pair.complaint(answer, bracket);
        EXPECT_TRUE(complaint.empty()) << to_string(method) << " " << complaint;
      }
    }
  }
}

TEST(HardCases, PolytopePairs) {
  const std::vector<PairText> pairs = oracle::read_folder(PROJECT_SOURCE_DIR "/../shared/hard_cases");
  if (pairs.empty()) GTEST_SKIP() << "the shared hard cases are not here";
  Scratch scratch;
  int judged = 0;
  for (const PairText& p : pairs) {
    if (!p.shape_a.polytope() || !p.shape_b.polytope()) continue;
    SCOPED_TRACE(p.name);
    judge_polytopes(p, scratch);
    ++judged;
  }
  std::printf("%d polytope pairs\n", judged);
}

TEST(HardCases, RoundedAndSmoothPairs) {
  const std::vector<PairText> pairs = oracle::read_folder(PROJECT_SOURCE_DIR "/../shared/hard_cases");
  if (pairs.empty()) GTEST_SKIP() << "the shared hard cases are not here";
  Scratch scratch;
  int judged = 0;
  for (const PairText& p : pairs) {
    if (p.shape_a.polytope() && p.shape_b.polytope()) continue;
    SCOPED_TRACE(p.name);
    const ConvexShape a = oracle::make_shape(p.shape_a);
    const ConvexShape b = oracle::make_shape(p.shape_b);
    const PosedShape posed_a{&a, make_pose(p.pose_a)};
    const PosedShape posed_b{&b, make_pose(p.pose_b)};
    const PenetrationDepth d = penetration_depth(posed_a, posed_b, scratch);
    const double size =
        1 + std::abs(p.signed_distance) + (posed_a.pose.translation() - posed_b.pose.translation()).norm();
    if (p.curved) {
      // The file's figure is an upper bound of the depth; our own sweep another one.
      const oracle::Sweep sweep = oracle::sweep_directions(posed_a, posed_b);
      const double least = std::min(static_cast<double>(sweep.least), -p.signed_distance);
      if (least > 1e-9 * size) {
        EXPECT_EQ(d.contact, ContactClass::overlapping);
        EXPECT_LE(d.lower, least * (1 + 1e-12));
        EXPECT_GE(d.upper, least * (1 - 1e-3) - 1e-5 * size);
        EXPECT_LE(d.upper, d.lower * (1 + 1e-6) * (1 + 1e-12) + 4e-12 * size);
      } else if (least < -1e-9 * size) {
        EXPECT_EQ(d.contact, ContactClass::separated);
        EXPECT_GE(d.distance_upper, -least * (1 - 1e-12));
        EXPECT_LE(d.distance_lower, -least * (1 + 1e-3) + 1e-5 * size);
      }
    } else {
      const double tolerance = std::max(p.tolerance, 1e-13 * size);
      const double found = d.contact == ContactClass::overlapping ? -d.depth : d.distance;
      EXPECT_NEAR(found, p.signed_distance, tolerance);
      EXPECT_LE(-d.upper - tolerance, std::min(p.signed_distance, 0.0));
      EXPECT_GE(d.upper - d.lower, 0);
      EXPECT_LE(d.upper - d.lower, 4e-15 * 8 * size);
    }
    EXPECT_NEAR(d.normal.norm(), 1, 1e-15);
    ++judged;
  }
  std::printf("%d rounded or smooth pairs\n", judged);
}

TEST(Corpus, EveryRegressionIsMended) {
  Scratch scratch;
  const std::vector<PairText> pairs = oracle::read_folder(PROJECT_SOURCE_DIR "/tests/corpus");
  for (const PairText& p : pairs) {
    SCOPED_TRACE(p.name);
    judge_polytopes(p, scratch);
  }
  std::printf("%zu regressions\n", pairs.size());
}

}  // namespace
}  // namespace pd
