// Exact predicates on posed pairs: every stage is reached, and says the same as the exact one.
#include "shape/posed_pair.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace {

using pd::ConvexPolytope;
using pd::Mat3;
using pd::Pose;
using pd::Vec3;
using pd::detail::Dyadic;
using pd::detail::Dyadic3;
using pd::detail::PairVector;
using pd::detail::PosedPair;

ConvexPolytope box(double x, double y, double z) { return ConvexPolytope::box(Vec3(x, y, z)).value(); }

Pose quaternion(double w, double x, double y, double z, const Vec3& t) {
  const double length = std::sqrt(w * w + x * x + y * y + z * z);
  return Pose::from_quaternion({w / length, x / length, y / length, z / length}, t).value();
}

PairVector any_vector(std::mt19937_64& bits) {
  const auto vertex = [&] { return static_cast<int>(bits() % 8); };
  const auto kind = bits() % 4;
  const std::array<int, 4> of{vertex(), vertex(), vertex(), vertex()};
  switch (kind) {
    case 0:
      return PairVector::point(of[0], of[1]);
    case 1:
      return PairVector::edge_a(of[0], of[1]);
    case 2:
      return PairVector::edge_b(of[0], of[1]);
    default:
      return PairVector::difference(of[0], of[1], of[2], of[3]);
  }
}

void expect_exact_signs(const PosedPair& pair, int rounds) {
  std::mt19937_64 bits(7);
  for (int i = 0; i < rounds; ++i) {
    const PairVector u = any_vector(bits), v = any_vector(bits), w = any_vector(bits);
    const Dyadic3 x = pair.exact(u), y = pair.exact(v), z = pair.exact(w);
    EXPECT_EQ(pair.sign_determinant(u, v, w), determinant(x, y, z).sign());
    EXPECT_EQ(pair.sign_dot(u, v), dot(x, y).sign());
    const Dyadic3 c = cross(x, y);
    EXPECT_EQ(pair.parallel(u, v), c.x.sign() == 0 && c.y.sign() == 0 && c.z.sign() == 0);
  }
}

TEST(PosedPair, FilterDecidesGenericPositions) {
  const ConvexPolytope a = box(1, 2, 3), b = box(0.5, 0.7, 0.9);
  const Pose pa = quaternion(1, 0.2, 0.3, 0.4, Vec3(0.1, 0.2, 0.3)), pb = quaternion(1, -0.5, 0.25, 0.1, Vec3(1, 1, 1));
  const PosedPair pair(a, pa, b, pb);
  for (int i = 1; i < 8; ++i) {
    EXPECT_NE(
        pair.sign_determinant(PairVector::point(0, 0), PairVector::edge_a(0, 1), PairVector::edge_b(0, i % 7 + 1)), 0);
  }
  EXPECT_EQ(pair.stages().double_double, 0);
  EXPECT_EQ(pair.stages().exact, 0);
  EXPECT_GT(pair.stages().filtered, 0);
}

TEST(PosedPair, DoubleDoubleDecidesNearTies) {
  const ConvexPolytope a = box(1, 1, 1), b = box(1, 1, 1);
  const Pose pa, pb = quaternion(1, 1e-20, 0, 0, Vec3(0, 0, 2));
  const PosedPair pair(a, pa, b, pb);
  // Edges along y of the two boxes enclose 2e-20 rad: below doubles, far above double-double.
  EXPECT_NE(pair.sign_determinant(PairVector::edge_a(0, 2), PairVector::edge_b(0, 2), PairVector::edge_a(0, 4)), 0);
  EXPECT_EQ(pair.stages().double_double, 1);
  EXPECT_EQ(pair.stages().exact, 0);
}

TEST(PosedPair, ExactStageDecidesTies) {
  const ConvexPolytope a = box(1, 1, 1), b = box(0.3, 0.3, 0.3);
  const Pose pa = quaternion(1, 0.2, 0.3, 0.4, Vec3::Zero()), pb = pa;
  const PosedPair pair(a, pa, b, pb);
  EXPECT_EQ(pair.sign_determinant(PairVector::edge_a(0, 1), PairVector::edge_b(0, 1), PairVector::point(3, 5)), 0);
  EXPECT_EQ(pair.stages().exact, 1);
}

TEST(PosedPair, EveryStageAgreesWithTheExactOne) {
  const ConvexPolytope a = box(1, 2, 0.5), b = box(1, 1, 1);
  const Pose identity;
  const Pose turned = quaternion(0.5, 0.5, 0.5, 0.5, Vec3(0.25, 0.5, -1));
  const Pose generic = quaternion(1, 0.1, 0.7, -0.3, Vec3(0.3, 0.1, 0.2));
  expect_exact_signs(PosedPair(a, identity, b, turned), 400);
  expect_exact_signs(PosedPair(a, generic, b, generic), 400);
  expect_exact_signs(PosedPair(a, generic, b, turned), 400);
}

/// The vector by big numbers alone. Requires rotations whose matrix of doubles is exact.
Dyadic3 by_hand(const PosedPair& pair, const PairVector& v) {
  const auto rotated = [](const ConvexPolytope& body, const Pose& pose, int to, int from) {
    const Vec3 zero = Vec3::Zero();
    const Dyadic3 d = pd::detail::to_dyadic(to >= 0 ? body.vertex(to) : zero) -
                      pd::detail::to_dyadic(from >= 0 ? body.vertex(from) : zero);
    const auto row = [&](int i) { return dot(pd::detail::to_dyadic(Vec3(pose.rotation().row(i))), d); };
    return Dyadic3{row(0), row(1), row(2)};
  };
  Dyadic3 r = rotated(pair.b(), pair.pose_b(), v.b_to, v.b_from) - rotated(pair.a(), pair.pose_a(), v.a_to, v.a_from);
  if (v.translated) {
    r = r + (pd::detail::to_dyadic(pair.pose_b().translation()) - pd::detail::to_dyadic(pair.pose_a().translation()));
  }
  return r;
}

TEST(PosedPair, NumbersThatDoNotRoundGiveTheSameSigns) {
  const ConvexPolytope whole = box(1, 2, 0.5), tenths = box(0.1, 0.7, 1.3);
  const Mat3 cycle{{0, 1, 0}, {0, 0, -1}, {-1, 0, 0}};
  const Mat3 thirds{{1.0 / 3, 2.0 / 3, 2.0 / 3}, {-2.0 / 3, 2.0 / 3, -1.0 / 3}, {-2.0 / 3, -1.0 / 3, 2.0 / 3}};
  const auto matrix = [](const Mat3& m, const Vec3& t) { return Pose::from_trusted_matrix(m, t); };
  const Pose poses[] = {Pose(), quaternion(0, 1, 0, 0, Vec3(0.25, 0.5, -1)), matrix(cycle, Vec3(-2, 0.125, 1)),
                        matrix(Mat3::Identity(), Vec3(1e-30, 0.1, 3)), matrix(thirds, Vec3(1, 2, 3))};
  std::int64_t exact = 0;
  for (const Pose& pose_a : poses) {
    for (const Pose& pose_b : poses) {
      for (const ConvexPolytope* const b : {&whole, &tenths}) {
        const PosedPair pair(whole, pose_a, *b, pose_b);
        std::mt19937_64 bits(11);
        for (int i = 0; i < 60; ++i) {
          const PairVector u = any_vector(bits), v = any_vector(bits), w = any_vector(bits);
          const Dyadic3 x = by_hand(pair, u), y = by_hand(pair, v), z = by_hand(pair, w);
          EXPECT_EQ(pair.sign_determinant(u, v, w), determinant(x, y, z).sign());
          const Dyadic3 c = cross(x, y);
          EXPECT_EQ(pair.parallel(u, v), c.x.sign() == 0 && c.y.sign() == 0 && c.z.sign() == 0);
          const Dyadic3 gap = pair.exact(u) - x * pair.homogeneous_factor();
          EXPECT_TRUE(gap.x.sign() == 0 && gap.y.sign() == 0 && gap.z.sign() == 0);
        }
        exact += pair.stages().exact;
      }
    }
  }
  EXPECT_GT(exact, 1000);
}

/// A coordinate along the axis of a turn, or across half a turn, is the body's own though the others are rounded, and
/// the offset may need two doubles.
TEST(PosedPair, TurnsAboutAnAxisKeepOneCoordinate) {
  const ConvexPolytope a = box(1, 0.75, 0.125), b = box(0.25, 1.5, 2);
  const Vec3 here(0.25, 0.5, -1), there(0x1p-60, -0x1p-70, 0x1p-80);
  struct Turn {
    Pose pose;
    int axis;  ///< whose coordinate is kept; -1: none
  };
  const Turn turns[] = {{quaternion(1, 0, 0, 0.3, here), 2},   {quaternion(0.2, 0, -1.7, 0, here), 1},
                        {quaternion(0.4, 0.9, 0, 0, here), 0}, {quaternion(0, 0.3, 1, 0, here), 2},
                        {quaternion(0, 1, 0, 0.2, here), 1},   {quaternion(0, 0, 0.8, 1, here), 0},
                        {quaternion(1, 0.1, 0, 0.3, here), -1}};
  for (const Turn& turn : turns) {
    const Pose pose_b(*Pose::from_quaternion({1, 0, 0, 0}, there));
    const PosedPair pair(a, turn.pose, b, pose_b);
    EXPECT_FALSE(pair.doubles_rotate());
    std::mt19937_64 bits(3);
    for (int k = 0; k < 3; ++k) {
      EXPECT_EQ(pair.has_own_coordinate(k), k == turn.axis);
      for (int i = 0; i < 50; ++i) {
        const PairVector v = any_vector(bits);
        pd::detail::DoubleDouble x;
        if (!pair.exact_coordinate(v, k, x)) {
          EXPECT_NE(k, turn.axis);
          continue;
        }
        const Dyadic3 exact = pair.exact(v);
        const Dyadic& coordinate = k == 0 ? exact.x : k == 1 ? exact.y : exact.z;
        EXPECT_EQ(((Dyadic(x.hi) + Dyadic(x.lo)) * pair.homogeneous_factor() - coordinate).sign(), 0);
      }
    }
    expect_exact_signs(pair, 200);
  }
}

/// Corners of two lenses that stand across each other: long coordinates, whose edges are parallel all the same.
TEST(PosedPair, TiesOfExchangedAxesTakeNoBigNumbers) {
  const ConvexPolytope a = box(0.1, 0.7, 1.3);
  std::vector<Vec3> points;
  for (const double x : {-0.3, 0.9}) {
    for (const double y : {-0.7, 0.1}) {
      for (const double z : {0.2, 1.1}) points.emplace_back(x, y, z);
    }
  }
  const ConvexPolytope b = *ConvexPolytope::from_points(points);
  const Mat3 exchanged{{0, 1, 0}, {1, 0, 0}, {0, 0, -1}}, cycle{{0, 1, 0}, {0, 0, -1}, {-1, 0, 0}};
  const Pose poses[] = {Pose(), Pose::from_trusted_matrix(exchanged, Vec3(0.1, 0.2, 0.3)),
                        Pose::from_trusted_matrix(cycle, Vec3(0.7, 0, 0.1)), quaternion(0, 1, 0, 0, Vec3(0.1, 0, 0)),
                        quaternion(1, 0.2, 0.3, 0.4, Vec3(0.1, 0.2, 0.3))};
  for (const Pose& pose : poses) {
    // One rotation for both, which need not be exact in doubles, or two that exchange axes.
    const PosedPair pair(a, pose, b, pose.is_quaternion() && pose.quaternion_wxyz()[0] != 0 ? pose : poses[1]);
    std::vector<PairVector> edges;
    for (int k = 0; k < 3; ++k) {
      edges.push_back(PairVector::edge_a(0, 4 >> k));
      edges.push_back(PairVector::edge_b(7, 7 - (4 >> k)));
    }
    std::vector<int> found;
    for (const PairVector& u : edges) {
      for (const PairVector& v : edges) {
        for (const PairVector& w : edges) found.push_back(pair.sign_determinant(u, v, w));
      }
    }
    EXPECT_EQ(pair.exact_work(), 0);
    EXPECT_GT(pair.stages().exact, 20);
    auto sign = found.begin();
    for (const PairVector& u : edges) {
      for (const PairVector& v : edges) {
        for (const PairVector& w : edges) {
          EXPECT_EQ(*sign++, determinant(pair.exact(u), pair.exact(v), pair.exact(w)).sign());
        }
      }
    }
  }
}

/// A body 1e-20 or 1e-40 times as large as the other: edges of either alone know no other size than their own.
TEST(PosedPair, TinyBodiesAreFilteredByTheirOwnSize) {
  for (const double ratio : {1e-20, 1e-40}) {
    const ConvexPolytope a = box(ratio, 2 * ratio, 3 * ratio), b = box(0.5, 0.7, 0.9);
    const Pose pa = quaternion(1, 0.2, 0.3, 0.4, Vec3(0.1, 0.2, 0.3)),
               pb = quaternion(1, -0.5, 0.25, 0.1, Vec3::Zero());
    const PosedPair pair(a, pa, b, pb);
    for (const int k : {1, 2, 4}) {
      const PairVector u = PairVector::edge_a(0, k), v = PairVector::edge_b(0, k), w = PairVector::edge_b(0, 7);
      EXPECT_NE(pair.sign_determinant(u, v, w), 0);
      EXPECT_NE(pair.sign_dot(u, v), 0);
      EXPECT_FALSE(pair.parallel(u, v));
    }
    EXPECT_EQ(pair.stages().filtered, 9);
    EXPECT_EQ(pair.stages().double_double + pair.stages().exact, 0);
    expect_exact_signs(pair, 200);
  }
}

/// Coordinates off by the least double, both bodies turned by one rotation: signs of edges, told without it.
TEST(PosedPair, OneRotationForBothIsLeftOut) {
  const double least = std::numeric_limits<double>::denorm_min();
  std::vector<Vec3> points;
  for (const double x : {-1.0, 1.0}) {
    for (const double y : {-1.0, 1.0}) {
      for (const double z : {0.0, 1.0}) points.emplace_back(x, y, z == 0 ? (x + 2 * y) * least : z);
    }
  }
  const ConvexPolytope a = box(1, 1, 1), b = *ConvexPolytope::from_points(points);
  const Pose pose = quaternion(1, 0.2, 0.3, 0.4, Vec3(0.1, 0.2, 0.3));
  const PosedPair pair(a, pose, b, pose);
  expect_exact_signs(pair, 400);
  const PosedPair asked(a, pose, b, pose);
  // Two edges of B's bottom against one of A's: flat but for the noise.
  const PairVector u = PairVector::edge_b(0, 2), v = PairVector::edge_b(0, 4), w = PairVector::edge_a(0, 2);
  const int sign = asked.sign_determinant(u, v, w);
  EXPECT_EQ(asked.stages().exact, 1);
  const std::int64_t work = asked.exact_work();
  EXPECT_EQ(sign, determinant(asked.exact(u), asked.exact(v), asked.exact(w)).sign());
  EXPECT_NE(sign, 0);
  EXPECT_LT(2 * work, asked.exact_work() - work);  // as products cost: shorter numbers
}

/// A matrix is taken as it stands, one that mirrors, too: signs are those of the turned vectors.
/// Bodies built along common axes and turned as a whole: all 48 exchanges of matrices, the half turns of quaternions.
TEST(PosedPair, ExchangedAxesOfOneRotationAreLeftOut) {
  const ConvexPolytope a = box(0.5, 0.25, 1), b = box(0.25, 0.75, 0.5);
  const Pose turn = quaternion(1, -0.5, 0.25, 0.1, Vec3(0.1, 0.2, 0.3));
  int matrices = 0;
  std::array<int, 3> axes{0, 1, 2};
  do {
    for (unsigned signs = 0; signs < 8; ++signs) {
      Mat3 exchange = Mat3::Zero();
      for (int k = 0; k < 3; ++k) exchange(k, axes[static_cast<std::size_t>(k)]) = (signs >> k & 1U) != 0 ? -1 : 1;
      const Pose pa = Pose::from_trusted_matrix(turn.rotation(), Vec3(0.1, 0.2, 0.3));
      const Pose pb = Pose::from_trusted_matrix(turn.rotation() * exchange, Vec3(1, 0.5, 0.25));
      const PosedPair pair(a, pa, b, pb);
      ASSERT_TRUE(pair.in_one_frame());
      EXPECT_EQ(pair.same_rotation(), exchange == Mat3::Identity());
      expect_exact_signs(pair, 100);
      ++matrices;
    }
  } while (std::next_permutation(axes.begin(), axes.end()));
  EXPECT_EQ(matrices, 48);
  const auto [w, x, y, z] = turn.quaternion_wxyz();
  for (const std::array<double, 4>& q :
       {std::array{-w, -x, -y, -z}, std::array{-x, w, z, -y}, std::array{y, z, -w, -x}, std::array{-z, y, -x, w}}) {
    const Pose pb = *Pose::from_quaternion(q, Vec3(1, 0.5, 0.25));
    const PosedPair pair(a, turn, b, pb);
    EXPECT_TRUE(pair.in_one_frame());
    expect_exact_signs(pair, 200);
  }
  const Pose quarter = quaternion(1, 1, 0, 0, Vec3::Zero());
  EXPECT_FALSE(PosedPair(a, turn, b, quarter).in_one_frame());
}

TEST(PosedPair, MirroredAxesKeepTheirSigns) {
  const ConvexPolytope a = box(0.1, 0.7, 1.3), b = box(0.3, 0.2, 0.9);
  const Mat3 mirror{{0, 1, 0}, {1, 0, 0}, {0, 0, 1}};
  const Pose mirrored = Pose::from_trusted_matrix(mirror, Vec3(0.1, 0.2, 0.3));
  expect_exact_signs(PosedPair(a, mirrored, b, mirrored), 200);
  expect_exact_signs(PosedPair(a, mirrored, b, Pose()), 200);
  const Mat3 flat{{1, 1, 0}, {0, 0, 0}, {0, 0, 1}};
  expect_exact_signs(PosedPair(a, Pose::from_trusted_matrix(flat, Vec3::Zero()), b, Pose()), 200);
}

TEST(PosedPair, NoScaleOverflowsOrUnderflows) {
  for (const double scale : {1e-290, 1e-150, 1e150, 1e290}) {
    const ConvexPolytope a = box(scale, 2 * scale, scale / 2), b = box(scale, scale, scale);
    const Pose identity;
    const Pose shifted = Pose::from_quaternion({0.6, 0.8, 0, 0}, Vec3(scale, 0, scale / 4)).value();
    expect_exact_signs(PosedPair(a, identity, b, shifted), 60);
  }
}

TEST(PosedPair, DecisionsObeyPowersOfTwo) {
  const ConvexPolytope a = box(1, 2, 3), b = box(0.5, 0.7, 0.9);
  const double k = 0x1p40;
  const ConvexPolytope a2 = box(k, 2 * k, 3 * k), b2 = box(0.5 * k, 0.7 * k, 0.9 * k);
  const Pose pa = quaternion(1, 0.2, 0.3, 0.4, Vec3(0.1, 0.2, 0.3)), pb = quaternion(1, -0.5, 0.25, 0.1, Vec3(1, 1, 1));
  const Pose pa2 = Pose::from_quaternion(pa.quaternion_wxyz(), pa.translation() * k).value();
  const Pose pb2 = Pose::from_quaternion(pb.quaternion_wxyz(), pb.translation() * k).value();
  const PosedPair one(a, pa, b, pb), two(a2, pa2, b2, pb2);
  std::mt19937_64 bits(3);
  for (int i = 0; i < 200; ++i) {
    const PairVector u = any_vector(bits);
    EXPECT_EQ(one.approximate(u) * k, two.approximate(u));
  }
}

}  // namespace
