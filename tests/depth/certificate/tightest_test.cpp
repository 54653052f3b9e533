/// @file
/// Tightest brackets: decided in double-double for bodies in general position, and right where the nearest simplex
/// shares no vertex.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

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

/// Boxes are judged by their fifteen axes, without a search and without exact signs where they do not tie.
TEST(Tightest, BoxesGoByTheirAxes) {
  Scratch scratch;
  for (const DepthClass depth : {DepthClass::shallow, DepthClass::mid, DepthClass::deep}) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      const JudgedPair pair = JudgedPair::of_family(PairFamily::box, 8, depth, seed);
      const PenetrationDepth answer = penetration_depth(pair.a(), pair.b(), scratch);
      const std::string complaint = pair.complaint(answer, Bracket::tightest);
      EXPECT_TRUE(complaint.empty()) << complaint;
      EXPECT_EQ(answer.method, Method::overlay) << pair.name();
      EXPECT_EQ(answer.statistics.support_calls, 0) << pair.name();
      EXPECT_LE(answer.statistics.exact_signs, 1) << pair.name();
    }
  }
}

std::array<int, 3> numbers(const Feature& f) { return {static_cast<int>(f.kind), f.first, f.second}; }

/// Every way to the nearest facet ends at the same one, also where several are exactly as near.
TEST(Tightest, BoxesHaveTheAnswersOfTheExpansion) {
  Scratch scratch;
  int tied = 0;
  for (const PairFamily family : {PairFamily::box, PairFamily::cubes, PairFamily::near_aligned_boxes}) {
    for (const DepthClass depth : {DepthClass::gap, DepthClass::shallow, DepthClass::mid, DepthClass::deep}) {
      for (std::uint64_t seed = 1; seed <= 60; ++seed) {
        const JudgedPair pair = JudgedPair::of_family(family, 8, depth, seed);
        const PenetrationDepth by_axes = penetration_depth(pair.a(), pair.b(), scratch);
        const PenetrationDepth searched = penetration_depth(pair.a(), pair.b(), scratch, {.method = Method::expansion});
        EXPECT_EQ(by_axes.contact, searched.contact) << pair.name();
        EXPECT_EQ(by_axes.lower, searched.lower) << pair.name();
        EXPECT_EQ(by_axes.upper, searched.upper) << pair.name();
        EXPECT_EQ(by_axes.normal, searched.normal) << pair.name();
        EXPECT_EQ(numbers(by_axes.feature_a), numbers(searched.feature_a)) << pair.name();
        EXPECT_EQ(numbers(by_axes.feature_b), numbers(searched.feature_b)) << pair.name();
        tied += by_axes.contact == ContactClass::overlapping && by_axes.method == Method::expansion;
      }
    }
  }
  EXPECT_GT(tied, 30);
}

/// Planes across a coordinate axis are known without error where coordinates are short: depths that are doubles, and
/// translations along the axis, need no big numbers.
TEST(Tightest, AlignedBoxesAreExactInDoubles) {
  Scratch scratch;
  const ConvexShape a(*ConvexPolytope::box(Vec3(1, 0.75, 0.5))), b(*ConvexPolytope::box(Vec3(0.25, 2, 1)));
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 apart = Vec3::Zero();
    apart[axis] = 0.875 * (a.polytope()->max_abs_coordinates() + b.polytope()->max_abs_coordinates())[axis];
    const Pose pose_b = *Pose::from_quaternion({1, 0, 0, 0}, apart);
    const PenetrationDepth answer = penetration_depth({&a, Pose()}, {&b, pose_b}, scratch);
    ASSERT_EQ(answer.contact, ContactClass::overlapping);
    EXPECT_EQ(answer.lower, answer.upper);
    EXPECT_EQ(answer.depth, apart[axis] / 7);
    Vec3 normal = Vec3::Zero();
    normal[axis] = -1;
    EXPECT_EQ(answer.normal, normal);
    EXPECT_EQ(answer.translation, answer.depth * normal);
    // The answer, and three pairs of parallel edges, whose poses are stored in different ways.
    EXPECT_LE(answer.statistics.exact_signs, 4);
  }
}

/// A box at rest on another, turned about the vertical: faces, edges and corners share one plane, which stored numbers
/// tell.
TEST(Tightest, BoxesAtRestAreExactAlongTheVertical) {
  Scratch scratch;
  const ConvexShape a(*ConvexPolytope::box(Vec3(0.3, 0.7, 0.1))), b(*ConvexPolytope::box(Vec3(1, 0.6, 0.2)));
  for (int i = 0; i < 40; ++i) {
    const double half = 0.07 * i - 1.3, sunk = std::ldexp(1.0, -5 - i);
    const Pose pose_a = *Pose::from_quaternion({std::cos(half), 0, 0, std::sin(half)}, {0.4, -0.3, 0.3 - sunk});
    const PenetrationDepth answer = penetration_depth({&a, pose_a}, {&b, Pose()}, scratch);
    ASSERT_EQ(answer.contact, ContactClass::overlapping);
    EXPECT_EQ(answer.normal, Vec3::UnitZ());
    // A sum of doubles, whose digits fit into the 64 bits of long doubles.
    const long double depth = static_cast<long double>(0.1) + 0.2 - pose_a.translation().z();
    EXPECT_LE(answer.lower, depth);
    EXPECT_GE(answer.depth, depth);
    EXPECT_LE(answer.depth, std::nextafter(answer.lower, 1.0));
    const PenetrationDepth searched =
        penetration_depth({&a, pose_a}, {&b, Pose()}, scratch, {.method = Method::overlay});
    EXPECT_EQ(answer.lower, searched.lower);
    EXPECT_EQ(answer.upper, searched.upper);
  }
}

/// Bodies at one place tie with their images, but where one is no image of itself: a face moved out by one double is
/// not the nearest any more.
TEST(Tightest, BodiesAtOnePlaceTieWithTheirImagesOnly) {
  Scratch scratch;
  const ConvexShape b(*ConvexPolytope::box(Vec3(0.5, 2, 2)));
  for (const double ulps : {0.0, 1.0, -1.0}) {
    const double right = 0.25 + ulps * 0x1p-54;
    std::vector<Vec3> corners;
    for (int v = 0; v < 8; ++v) {
      corners.emplace_back((v & 4) != 0 ? right : -0.25, (v & 2) != 0 ? 1 : -1, (v & 1) != 0 ? 1 : -1);
    }
    const ConvexShape a(*ConvexPolytope::from_points(corners));
    const Pose pose_a = *Pose::from_quaternion({1, 1e-9, 2e-9, 3e-9}, Vec3::Zero());
    const PenetrationDepth answer = penetration_depth({&a, pose_a}, {&b, Pose()}, scratch);
    const PenetrationDepth searched =
        penetration_depth({&a, pose_a}, {&b, Pose()}, scratch, {.method = Method::overlay});
    EXPECT_EQ(answer.lower, searched.lower) << ulps;
    EXPECT_EQ(answer.upper, searched.upper) << ulps;
    // It leaves by its left face, to the right, where its right face is farther out.
    if (ulps == 0) continue;
    EXPECT_EQ(answer.normal.x() > 0, ulps > 0) << answer.normal.transpose();
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
