/// @file
/// The linear program's class against that of the depth engines, and its direction against exact integers.
#include "pd/depth/linear_separation.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "oracle/judged_pair.hpp"

namespace pd {
namespace {

using oracle::JudgedPair;

/// Exact max over A of <n, a> less min over B of <n, b>: its sign.
int gap_sign(const JudgedPair& pair, const Vec3& n) {
  int least = 0;
  for (const double x : n) {
    if (x != 0) least = std::min(least, std::ilogb(x) - 52);
  }
  const auto integer = [&](double x) {
    const int shift = x == 0 ? 0 : std::ilogb(x) - 52;
    return oracle::shifted(oracle::Integer(static_cast<std::int64_t>(std::ldexp(x, -shift))), shift - least);
  };
  const oracle::IVec against{-integer(n.x()), -integer(n.y()), -integer(n.z())};
  // h_P(-n) < 0 says that every b - a has <b - a, n> > 0.
  return pair.exact().exact_support(against, -n).sign();
}

class LinearSeparations : public testing::TestWithParam<int> {};

TEST_P(LinearSeparations, ClassesAreThoseOfTheDepth) {
  const auto family = static_cast<scenes::PairFamily>(GetParam());
  Scratch scratch;
  for (int d = 0; d < scenes::kDepthClasses; ++d) {
    for (const int n : {3, 4, 6, 9, 24}) {
      for (std::uint64_t seed = 1; seed <= 8; ++seed) {
        const JudgedPair pair = JudgedPair::of_family(family, n, static_cast<scenes::DepthClass>(d), seed);
        const PosedShape a = pair.a(), b = pair.b();
        const PenetrationDepth depth = penetration_depth(a, b, scratch);
        const LinearSeparation found = linear_separation(*a.shape->polytope(), a.pose, *b.shape->polytope(), b.pose);
        ASSERT_EQ(found.contact, depth.contact) << pair.name() << " seed " << seed << " n " << n << " d " << d;
        if (found.contact != ContactClass::separated) continue;
        EXPECT_NEAR(found.direction.norm(), 1, 4 * 0x1p-52);
        if (found.strict) {
          EXPECT_LT(gap_sign(pair, found.direction), 0) << pair.name();
        } else {
          EXPECT_LT(depth.distance, 1e-14 * pair.extent()) << pair.name();
        }
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, LinearSeparations, testing::Range(0, scenes::kPairFamilies), [](const auto& tested) {
  return std::string(to_string(static_cast<scenes::PairFamily>(tested.param)));
});

TEST(LinearSeparation, TouchingInEveryDimension) {
  // Faces, edges and corners that meet, overlap in the common plane or line, or miss each other there.
  const ConvexPolytope box = *ConvexPolytope::box(Vec3(1, 1, 1));
  const auto contact = [&](double x, double y, double z) {
    return linear_separation(box, Pose(), box, *Pose::from_matrix(Mat3::Identity(), Vec3(x, y, z))).contact;
  };
  EXPECT_EQ(contact(1.5, 1.5, 1.5), ContactClass::overlapping);
  EXPECT_EQ(contact(0, 0, 0), ContactClass::overlapping);
  EXPECT_EQ(contact(2, 0.5, 0), ContactClass::touching);
  EXPECT_EQ(contact(2, 2, 0), ContactClass::touching);
  EXPECT_EQ(contact(2, 2, 2), ContactClass::touching);
  EXPECT_EQ(contact(2, 2.5, 0), ContactClass::separated);
  EXPECT_EQ(contact(2, 2, 2.5), ContactClass::separated);
  EXPECT_EQ(contact(2, 2, std::nextafter(2, 3)), ContactClass::separated);
  EXPECT_EQ(contact(std::nextafter(2, 1), 0, 0), ContactClass::overlapping);
}

TEST(LinearSeparation, FlatBodies) {
  const auto hull = [](std::vector<Vec3> points) { return *ConvexPolytope::from_points(points); };
  const ConvexPolytope point = hull({{0, 0, 0}});
  const ConvexPolytope segment = hull({{-1, 0, 0}, {1, 0, 0}});
  const ConvexPolytope square = hull({{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}});
  const auto at = [](double x, double y, double z) { return *Pose::from_matrix(Mat3::Identity(), Vec3(x, y, z)); };
  const auto contact = [&](const ConvexPolytope& a, const ConvexPolytope& b, const Pose& pose) {
    return linear_separation(a, Pose(), b, pose).contact;
  };
  EXPECT_EQ(contact(point, point, Pose()), ContactClass::touching);
  EXPECT_EQ(contact(point, point, at(0, 1e-300, 0)), ContactClass::separated);
  EXPECT_EQ(contact(segment, segment, at(2, 0, 0)), ContactClass::touching);
  EXPECT_EQ(contact(segment, segment, at(2.5, 0, 0)), ContactClass::separated);
  EXPECT_EQ(contact(segment, segment, at(1, 1, 0)), ContactClass::separated);
  EXPECT_EQ(contact(square, segment, at(0.5, 0.5, 0)), ContactClass::touching);
  EXPECT_EQ(contact(square, square, at(0.5, 0.5, 0)), ContactClass::touching);
  EXPECT_EQ(contact(square, square, at(2, 2, 0)), ContactClass::touching);
  EXPECT_EQ(contact(square, square, at(2, 2.5, 0)), ContactClass::separated);
  EXPECT_EQ(contact(square, point, at(0.25, 0.5, 0)), ContactClass::touching);
}

TEST(LinearSeparation, SignTestsGrowLinearly) {
  scenes::Random random(7);
  for (const int n : {100, 1000, 10000, 100000}) {
    const ConvexPolytope ball = *ConvexPolytope::from_points(scenes::sphere_hull(n, random));
    for (const double x : {0.5, 1.99, 2.01}) {
      const LinearSeparation found =
          linear_separation(ball, Pose(), ball, *Pose::from_matrix(Mat3::Identity(), x * random.direction()));
      EXPECT_LT(static_cast<double>(found.sign_tests), 40.0 * 2 * n) << n << " " << x;
    }
  }
}

}  // namespace
}  // namespace pd
