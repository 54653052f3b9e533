/// @file
/// Two boxes by the kernel for boxes (certified bracket) against the tightest answer, which goes through exact
/// arithmetic; the facets that the kernel leaves to that; boxes of whole numbers.
#include "depth/facets/gauss_boxes.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include "depth/facets/gauss_sat_boxes.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"

namespace pd {
namespace {

/// For `single_at_rest` the rotations are rounded to single precision, so that faces are off a right angle by 1e-7.
enum class Turn { any, shared, none, nearly_shared, at_rest, single_at_rest };

struct Boxes {
  Vec3 half_a, half_b;
  ConvexShape a, b;
  Pose pose_a, pose_b;
};

Boxes draw(Turn turn, std::mt19937_64& random) {
  std::uniform_real_distribution<double> extent(0.1, 1);
  std::normal_distribution<double> normal;
  const auto vector = [&] { return Vec3{normal(random), normal(random), normal(random)}; };
  const auto rotation = [&] {
    return Mat3(
        Eigen::Quaterniond{normal(random), normal(random), normal(random), normal(random)}.normalized().matrix());
  };
  const bool aligned = turn == Turn::none;
  const auto half = [&] {
    return aligned ? Vec3(0.5, 0.5, 0.5) : Vec3{extent(random), extent(random), extent(random)};
  };
  const Vec3 half_a = half(), half_b = half();
  Mat3 of_a = aligned ? Mat3(Mat3::Identity()) : rotation();
  Mat3 of_b = turn == Turn::any ? rotation() : of_a;
  if (turn == Turn::nearly_shared) of_b = of_a * Eigen::AngleAxisd(1e-7 * normal(random), Vec3::UnitZ()).matrix();
  const bool single = turn == Turn::single_at_rest, rests = turn == Turn::at_rest || single;
  if (rests) of_b = of_a * Eigen::AngleAxisd(normal(random), Vec3::UnitZ()).matrix();
  Vec3 apart = 0.4 * vector();
  // B lies on A, face on face, wherever: corners on faces, or edges that cross alone.
  if (rests) {
    const double depth = extent(random) * (single ? half_a.z() + half_b.z() : 1e-3);
    apart = of_a * Vec3{1.2 * half_a.x() * (2 * extent(random) - 1), 1.2 * half_a.y() * (2 * extent(random) - 1),
                        half_a.z() + half_b.z() - depth};
  }
  if (single) {
    of_a = of_a.cast<float>().cast<double>().eval();
    of_b = of_b.cast<float>().cast<double>().eval();
  }
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
  return ((pose.rotation().inverse() * (point - pose.translation())).cwiseAbs() - half).maxCoeff();
}

/// The facets that may be nearest; returns what no other one is nearer than.
double near_facets(const Boxes& boxes, detail::NearGaussPieces& near) {
  const ConvexPolytope &a = *boxes.a.polytope(), &b = *boxes.b.polytope();
  const detail::BoxFrame frame_a = *detail::box_frame(a), frame_b = *detail::box_frame(b);
  near.count = 0;
  return detail::gauss_sat_of_boxes({a, frame_a, boxes.pose_a}, {b, frame_b, boxes.pose_b}, {},
                                    detail::BoxQuestion::near_pieces, &near)
      .nearest.beyond;
}

/// The edges along which a facet of a box extends, as bits.
int flat_bits(const ConvexPolytope& box, int facet) {
  int bits = 0;
  for (int k = 0; k < 3; ++k) bits |= std::abs(box.facet_normal(facet)[k]) < 0.5 ? 4 >> k : 0;
  return bits;
}

class BoxPairs : public ::testing::TestWithParam<Turn> {};

TEST_P(BoxPairs, CertifiedBracketsHoldTheExactDepth) {
  std::mt19937_64 random(7);
  Scratch scratch;
  int overlapping = 0, by_axes = 0, proved = 0;
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
    proved += exact.method == Method::overlay;
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
  // Edges nearly but not quite parallel are left to the surface, unless they cross along the normal of flush faces.
  if (GetParam() == Turn::any || GetParam() == Turn::none) {
    EXPECT_GT(by_axes, overlapping * 9 / 10);
  }
  if (GetParam() == Turn::at_rest || GetParam() == Turn::single_at_rest) {
    EXPECT_EQ(by_axes, overlapping);
    EXPECT_GT(proved, overlapping * 9 / 10) << overlapping;
  }
}

INSTANTIATE_TEST_SUITE_P(Turns, BoxPairs,
                         ::testing::Values(Turn::any, Turn::shared, Turn::none, Turn::nearly_shared, Turn::at_rest,
                                           Turn::single_at_rest));

/// Edges turned from each other by 1e-9 to 1e-5 span a plane that doubles know to seven digits or less. Its facet is a
/// strip, the nearest one only to an origin as close to it as it is wide: the origin is put there. What is not listed
/// lies as far away as it is said to, in the 64 bits of long doubles.
TEST(BoxNearFacets, NoFacetLeftOutIsNearer) {
  typedef Eigen::Matrix<long double, 3, 1> Long3;
  std::mt19937_64 random(8);
  std::uniform_real_distribution<double> power(-9, -5), share(0.05, 0.3);
  std::normal_distribution<double> normal;
  detail::NearGaussPieces near;
  int asked = 0, left_out = 0;
  for (int i = 0; i < 4000; ++i) {
    SCOPED_TRACE(i);
    Boxes boxes = draw(Turn::shared, random);
    const Vec3 axis = Vec3{normal(random), normal(random), normal(random)}.normalized();
    const Mat3 turn = Eigen::AngleAxisd(std::pow(10, power(random)), axis).matrix();
    const Mat3 of_a = boxes.pose_a.rotation(), of_b = of_a * turn;
    Long3 generators[6];
    for (int k = 0; k < 3; ++k) {
      generators[k] = of_a.col(k).cast<long double>() * boxes.half_a[k];
      generators[k + 3] = of_b.col(k).cast<long double>() * boxes.half_b[k];
    }
    const int strip = i % 3;
    const Long3 across = generators[strip].cross(generators[strip + 3]);
    const Long3 outward = across.normalized();
    Long3 middle = Long3::Zero();
    for (int k = 0; k < 6; ++k) {
      if (k % 3 != strip) middle += (outward.dot(generators[k]) > 0 ? 1 : -1) * generators[k];
    }
    const long double width = across.norm() / std::max(boxes.half_a[strip], boxes.half_b[strip]);
    const Vec3 offset = (share(random) * width * outward - middle).cast<double>();
    boxes.pose_a = *Pose::from_matrix(of_a, Vec3::Zero());
    boxes.pose_b = *Pose::from_matrix(of_b, offset);
    const double beyond = near_facets(boxes, near);
    if (near.count == 0) continue;
    ++asked;
    // Bits of the axes along which a listed facet extends, of A and of B.
    bool listed[8][8] = {};
    for (int k = 0; k < near.count; ++k) {
      const detail::GaussPiece& p = near.pieces[k].piece;
      if (p.is_of_edges()) {
        listed[p.a[0] ^ p.a[1]][p.b[0] ^ p.b[1]] = true;
      } else {
        listed[p.facet_a < 0 ? 0 : flat_bits(*boxes.a.polytope(), p.facet_a)]
              [p.facet_b < 0 ? 0 : flat_bits(*boxes.b.polytope(), p.facet_b)] = true;
      }
    }
    for (int u = 0; u < 6; ++u) {
      for (int v = u + 1; v < 6; ++v) {
        const int bits_a = (u < 3 ? 4 >> u : 0) | (v < 3 ? 4 >> v : 0);
        const int bits_b = (u >= 3 ? 4 >> (u - 3) : 0) | (v >= 3 ? 4 >> (v - 3) : 0);
        if (listed[bits_a][bits_b]) continue;
        if (u < 3 && v >= 3 && (near.parallel >> (3 * u + v - 3) & 1) != 0) continue;
        ++left_out;
        const Long3 n = generators[u].cross(generators[v]).normalized();
        long double distance = -std::abs(n.dot(offset.cast<long double>()));
        for (const Long3& g : generators) distance += std::abs(n.dot(g));
        EXPECT_GE(distance, beyond * (1 - 1e-15L));
      }
    }
  }
  EXPECT_GT(asked, 500);
  EXPECT_GT(left_out, asked);
}

/// Boxes on a grid of eighths, turned by right angles: their difference is a box of eighths, whose depth is known in
/// whole numbers, tied or not.
TEST(AlignedBoxes, TheirDepthIsExact) {
  std::mt19937_64 random(10);
  std::uniform_int_distribution<int> eighths(1, 8), place(-9, 9), order(0, 5), side(0, 1);
  const auto half = [&]() -> Vec3 {
    return Eigen::Vector3i{eighths(random), eighths(random), eighths(random)}.cast<double>() / 8;
  };
  const auto turn = [&] {
    Mat3 m = Mat3::Zero();
    int axes[3] = {0, 1, 2};
    for (int k = order(random); k > 0; --k) std::next_permutation(axes, axes + 3);
    for (int k = 0; k < 3; ++k) m(axes[k], k) = side(random) != 0 ? 1 : -1;
    if (m.determinant() < 0) m.col(0) = -m.col(0);
    return m;
  };
  Scratch scratch;
  int found = 0, tied = 0;
  for (int i = 0; i < 1000; ++i) {
    SCOPED_TRACE(i);
    const Vec3 half_a = half(), half_b = half();
    const ConvexShape a(*ConvexPolytope::box(half_a)), b(*ConvexPolytope::box(half_b));
    const Pose pose_a = *Pose::from_matrix(turn(), Vec3::Zero());
    const Vec3 centre_b = Eigen::Vector3i{place(random), place(random), place(random)}.cast<double>() / 8;
    const Pose pose_b = *Pose::from_matrix(turn(), centre_b);
    const Vec3 reach = (pose_a.rotation() * half_a).cwiseAbs() + (pose_b.rotation() * half_b).cwiseAbs();
    const Vec3 sides[2] = {reach + pose_b.translation(), reach - pose_b.translation()};
    const double least = std::min(sides[0].minCoeff(), sides[1].minCoeff());
    const auto as_near = (sides[0].array() == least).count() + (sides[1].array() == least).count();
    const PenetrationDepth answer = penetration_depth({&a, pose_a}, {&b, pose_b}, scratch);
    ASSERT_EQ(answer.contact, least > 0    ? ContactClass::overlapping
                              : least == 0 ? ContactClass::touching
                                           : ContactClass::separated);
    if (least <= 0) continue;
    EXPECT_EQ(answer.lower, least);
    EXPECT_EQ(answer.upper, least);
    EXPECT_EQ(answer.translation.cwiseAbs().maxCoeff(), least);
    ++(as_near == 1 ? found : tied);
  }
  EXPECT_GT(found, 200);
  EXPECT_GT(tied, 50);
}

/// An offset that one double does not hold.
TEST(AlignedBoxes, AreToldBeyondOneDouble) {
  const ConvexShape box(*ConvexPolytope::box({1, 2, 3}));
  const auto at = [](double x) { return *Pose::from_matrix(Mat3::Identity(), {x, 0, 0}); };
  Scratch scratch;
  const PenetrationDepth answer = penetration_depth({&box, at(1)}, {&box, at(0x1p-60)}, scratch);
  EXPECT_EQ(answer.lower, 1);
  EXPECT_EQ(answer.upper, 1 + 0x1p-52);
}

TEST(BoxFrame, OnlyBoxesAlongTheirOwnAxes) {
  EXPECT_TRUE(detail::box_frame(*ConvexPolytope::box({1, 2, 3})));
  std::vector<Vec3> corners;
  for (int i = 0; i < 8; ++i) corners.emplace_back(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
  corners[7].x() = 1.5;
  EXPECT_FALSE(detail::box_frame(*ConvexPolytope::from_points(corners)));
  corners.pop_back();
  EXPECT_FALSE(detail::box_frame(*ConvexPolytope::from_points(corners)));
}

/// Thinner ones are left alone: fourth powers of extents must be ordinary numbers, with room.
TEST(BoxFrame, AreThickerThanTwoToTheMinus200) {
  EXPECT_TRUE(detail::box_frame(*ConvexPolytope::box({1, 1, 0x1p-200})));
  EXPECT_FALSE(detail::box_frame(*ConvexPolytope::box({1, 1, 0x1p-201})));
}

}  // namespace
}  // namespace pd
