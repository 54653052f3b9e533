/// @file
/// Two boxes by their fifteen axes (certified bracket) against the tightest answer, which goes through exact
/// arithmetic.
#include "depth/facets/box_sat.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"

namespace pd {
namespace {

enum class Turn { any, shared, none, nearly_shared };

struct Boxes {
  Vec3 half_a, half_b;
  ConvexShape a, b;
  Pose pose_a, pose_b;
};

Boxes draw(Turn turn, std::mt19937_64& random) {
  std::uniform_real_distribution<double> extent(0.1, 1);
  std::normal_distribution<double> normal;
  const auto vector = [&] { return Vec3(normal(random), normal(random), normal(random)); };
  const auto rotation = [&] {
    return Mat3(
        Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random)).normalized().matrix());
  };
  const bool aligned = turn == Turn::none;
  const auto half = [&] {
    return aligned ? Vec3(0.5, 0.5, 0.5) : Vec3(extent(random), extent(random), extent(random));
  };
  const Vec3 half_a = half(), half_b = half();
  const Mat3 of_a = aligned ? Mat3(Mat3::Identity()) : rotation();
  Mat3 of_b = turn == Turn::any ? rotation() : of_a;
  if (turn == Turn::nearly_shared) of_b = of_a * Eigen::AngleAxisd(1e-7 * normal(random), Vec3::UnitZ()).matrix();
  Vec3 apart = 0.4 * vector();
  if (aligned) apart = (64 * apart / 8).array().round() / 8;
  const Vec3 at = vector();
  return {half_a,
          half_b,
          ConvexShape(*ConvexPolytope::box(half_a)),
          ConvexShape(*ConvexPolytope::box(half_b)),
          *Pose::from_matrix(of_a, at),
          *Pose::from_matrix(of_b, at + apart)};
}

double outside(const Vec3& point, const Pose& pose, const Vec3& half) {
  return ((pose.rotation().transpose() * (point - pose.translation())).cwiseAbs() - half).maxCoeff();
}

class BoxPairs : public ::testing::TestWithParam<Turn> {};

TEST_P(BoxPairs, CertifiedBracketsHoldTheExactDepth) {
  std::mt19937_64 random(7);
  Scratch scratch;
  int overlapping = 0, by_axes = 0;
  for (int i = 0; i < 1000; ++i) {
    SCOPED_TRACE(i);
    const Boxes boxes = draw(GetParam(), random);
    const PosedShape a{&boxes.a, boxes.pose_a}, b{&boxes.b, boxes.pose_b};
    const PenetrationDepth fast = penetration_depth(a, b, scratch, {.bracket = Bracket::certified});
    const PenetrationDepth exact = penetration_depth(a, b, scratch);
    ASSERT_EQ(fast.contact, exact.contact);
    if (exact.contact != ContactClass::overlapping) continue;
    ++overlapping;
    by_axes += fast.method == Method::overlay;
    EXPECT_LE(fast.lower, exact.upper);
    EXPECT_GE(fast.upper, exact.lower);
    const double size =
        boxes.half_a.sum() + boxes.half_b.sum() + (boxes.pose_b.translation() - boxes.pose_a.translation()).norm();
    EXPECT_LE(fast.upper - fast.lower, 2e-14 * size);
    EXPECT_LE(outside(fast.witness_a, boxes.pose_a, boxes.half_a), 2e-14 * size);
    EXPECT_LE(outside(fast.witness_b, boxes.pose_b, boxes.half_b), 2e-14 * size);
    EXPECT_LE((fast.witness_b - fast.witness_a - fast.translation).norm(), 2e-15 * size);
  }
  EXPECT_GT(overlapping, 500);
  // Edges nearly but not quite parallel are left to the surface.
  if (GetParam() == Turn::any) {
    EXPECT_GT(by_axes, overlapping * 9 / 10);
  }
}

INSTANTIATE_TEST_SUITE_P(Turns, BoxPairs, ::testing::Values(Turn::any, Turn::shared, Turn::none, Turn::nearly_shared));

TEST(BoxFrame, OnlyBoxesAlongTheirOwnAxes) {
  EXPECT_TRUE(detail::box_frame(*ConvexPolytope::box({1, 2, 3})));
  std::vector<Vec3> corners;
  for (int i = 0; i < 8; ++i) corners.emplace_back(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
  corners[7].x() = 1.5;
  EXPECT_FALSE(detail::box_frame(*ConvexPolytope::from_points(corners)));
  corners.pop_back();
  EXPECT_FALSE(detail::box_frame(*ConvexPolytope::from_points(corners)));
}

}  // namespace
}  // namespace pd
