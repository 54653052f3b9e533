/// @file
/// The algebra of penetration depth: swap, exact rigid motions, powers of two, order and duplicates of vertices,
/// inclusion, concavity and Lipschitz, width.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <thread>

#include "oracle/judged_pair.hpp"
#include "pd/depth/width.hpp"

namespace pd {
namespace {

using oracle::JudgedPair;
using scenes::DepthClass;
using scenes::PairFamily;
using scenes::PointPair;

/// Same bits in every field (signed zeros count as equal: 0 and -0 are one number).
void expect_same(const PenetrationDepth& p, const PenetrationDepth& q) {
  EXPECT_EQ(p.contact, q.contact);
  EXPECT_EQ(p.depth, q.depth);
  EXPECT_EQ(p.lower, q.lower);
  EXPECT_EQ(p.upper, q.upper);
  EXPECT_EQ(p.distance, q.distance);
  EXPECT_EQ(p.distance_lower, q.distance_lower);
  EXPECT_EQ(p.distance_upper, q.distance_upper);
  EXPECT_EQ(p.translation, q.translation);
  EXPECT_EQ(p.normal, q.normal);
  EXPECT_EQ(p.witness_a, q.witness_a);
  EXPECT_EQ(p.witness_b, q.witness_b);
}

/// Every family and depth, a few seeds: `body(pair, scratch)`.
template <class Function>
void for_each_pair(const std::vector<int>& sizes, std::uint64_t seeds, Function&& body) {
  Scratch scratch;
  for (int f = 0; f < scenes::kPairFamilies; ++f) {
    for (int d = 0; d < scenes::kDepthClasses; ++d) {
      for (const int n : sizes) {
        for (std::uint64_t seed = 101; seed < 101 + seeds; ++seed) {
          const JudgedPair pair =
              JudgedPair::of_family(static_cast<PairFamily>(f), n, static_cast<DepthClass>(d), seed);
          SCOPED_TRACE(pair.name());
          body(pair, scratch);
          if (testing::Test::HasFatalFailure()) return;
        }
      }
    }
  }
}

Pose with(const Pose& pose, const Mat3& rotation, const Vec3& translation) {
  (void)pose;
  return Pose::from_trusted_matrix(rotation, translation);
}

TEST(Laws, SwapNegatesTheAnswer) {
  for_each_pair({6, 16}, 2, [](const JudgedPair& pair, Scratch& scratch) {
    const PenetrationDepth forth = penetration_depth(pair.a(), pair.b(), scratch);
    PenetrationDepth back = penetration_depth(pair.b(), pair.a(), scratch);
    // Equal point sets have no first body: only the lengths must agree.
    if (pair.name().starts_with("equal_bodies") || pair.name().starts_with("points")) {
      EXPECT_EQ(forth.contact, back.contact);
      EXPECT_EQ(forth.lower, back.lower);
      EXPECT_EQ(forth.upper, back.upper);
      return;
    }
    back.translation = -back.translation;
    back.normal = -back.normal;
    std::swap(back.witness_a, back.witness_b);
    expect_same(forth, back);
  });
}

TEST(Laws, OrderAndDuplicatesOfVerticesDoNotMatter) {
  for_each_pair({6, 16}, 1, [](const JudgedPair& pair, Scratch& scratch) {
    const PenetrationDepth plain = penetration_depth(pair.a(), pair.b(), scratch);
    PointPair points = pair.points();
    scenes::Random random(5);
    for (scenes::Points* body : {&points.a, &points.b}) {
      body->push_back((*body)[static_cast<std::size_t>(random.integer(0, static_cast<int>(body->size()) - 1))]);
      for (std::size_t i = body->size() - 1; i > 0; --i) {
        std::swap((*body)[i], (*body)[static_cast<std::size_t>(random.integer(0, static_cast<int>(i)))]);
      }
    }
    const JudgedPair shuffled(points);
    expect_same(plain, penetration_depth(shuffled.a(), shuffled.b(), scratch));
  });
}

TEST(Laws, PowersOfTwoScaleEveryBit) {
  for_each_pair({6, 16}, 1, [](const JudgedPair& pair, Scratch& scratch) {
    // Not near the ends of the range, where numbers lose bits.
    if (pair.name().starts_with("scales")) return;
    for (const int power : {-600, -40, 3, 60, 600}) {
      if (power == -600 && pair.name().starts_with("ulp_noise")) continue;  // likewise
      const double s = std::ldexp(1.0, power);
      PointPair points = pair.points();
      for (scenes::Points* body : {&points.a, &points.b}) {
        for (Vec3& p : *body) p *= s;
      }
      for (Pose* pose : {&points.pose_a, &points.pose_b}) {
        const Vec3 t = pose->translation() * s;
        *pose = pose->is_quaternion() ? *Pose::from_quaternion(pose->quaternion_wxyz(), t)
                                      : Pose::from_trusted_matrix(pose->rotation(), t);
      }
      const JudgedPair scaled(points);
      SCOPED_TRACE(power);
      for (const Bracket bracket : {Bracket::tightest, Bracket::certified, Bracket::contact}) {
        SCOPED_TRACE(static_cast<int>(bracket));
        DepthSettings settings{.bracket = bracket, .contact_tolerance = 0x1p-30};
        const PenetrationDepth plain = penetration_depth(pair.a(), pair.b(), scratch, settings);
        settings.contact_tolerance *= s;
        PenetrationDepth answer = penetration_depth(scaled.a(), scaled.b(), scratch, settings);
        for (double* length : {&answer.depth, &answer.lower, &answer.upper, &answer.distance, &answer.distance_lower,
                               &answer.distance_upper}) {
          *length /= s;
        }
        answer.translation /= s;
        answer.witness_a /= s;
        answer.witness_b /= s;
        expect_same(plain, answer);
      }
    }
  });
}

TEST(Laws, ExactRigidMotionsOfBothKeepClassAndDepth) {
  // Right angles on matrix poses with integer or dyadic numbers are exact, so that the true depth is the same number.
  Mat3 quarter = Mat3::Zero();
  quarter(0, 1) = -1;
  quarter(1, 2) = 1;
  quarter(2, 0) = -1;
  for_each_pair({6, 16}, 1, [&](const JudgedPair& pair, Scratch& scratch) {
    PointPair points = pair.points();
    if (points.pose_a.is_quaternion() || points.pose_b.is_quaternion()) {
      // Turning the bodies themselves is exact too: the pose then starts from the turned points.
      for (scenes::Points* body : {&points.a, &points.b}) {
        for (Vec3& p : *body) p = Vec3(-p.x(), -p.y(), p.z());
      }
      const auto half_turn = [](const Pose& pose) {
        const auto& q = pose.quaternion_wxyz();  // q * k: undoes the half turn about z
        return *Pose::from_quaternion({-q[3], q[2], -q[1], q[0]}, pose.translation());
      };
      if (points.pose_a.is_quaternion()) points.pose_a = half_turn(points.pose_a);
      if (points.pose_b.is_quaternion()) points.pose_b = half_turn(points.pose_b);
      if (!pair.points().pose_a.is_quaternion() || !pair.points().pose_b.is_quaternion()) return;
    } else {
      points.pose_a = with(points.pose_a, quarter * points.pose_a.rotation(), quarter * points.pose_a.translation());
      points.pose_b = with(points.pose_b, quarter * points.pose_b.rotation(), quarter * points.pose_b.translation());
    }
    const JudgedPair moved(points);
    const DepthSettings tight{.bracket = Bracket::tightest};
    const PenetrationDepth before = penetration_depth(pair.a(), pair.b(), scratch, tight);
    const PenetrationDepth after = penetration_depth(moved.a(), moved.b(), scratch, tight);
    EXPECT_EQ(before.contact, after.contact);
    EXPECT_EQ(before.lower, after.lower);
    EXPECT_LE(std::abs(before.upper - after.upper), std::nextafter(before.upper, INFINITY) - before.upper);
    EXPECT_EQ(before.distance_lower, after.distance_lower);
  });
}

TEST(Laws, LargerBodiesAreNotShallower) {
  for_each_pair({6, 16}, 1, [](const JudgedPair& pair, Scratch& scratch) {
    const PenetrationDepth small = penetration_depth(pair.a(), pair.b(), scratch);
    PointPair points = pair.points();
    points.a.push_back(1.25 * points.a[0] - 0.25 * points.a.back());
    const JudgedPair grown(points);
    const PenetrationDepth large = penetration_depth(grown.a(), grown.b(), scratch);
    EXPECT_LE(static_cast<int>(small.contact), static_cast<int>(large.contact));
    EXPECT_LE(small.lower, large.upper);
    EXPECT_GE(small.distance_upper, large.distance_lower);
  });
}

TEST(Laws, SignedDepthIsConcaveInsideAndLipschitz) {
  scenes::Random random(17);
  for_each_pair({8}, 1, [&](const JudgedPair& pair, Scratch& scratch) {
    if (pair.name().starts_with("scales") || pair.name().starts_with("far")) return;
    const double extent = pair.extent();
    const Vec3 step = random.direction() * (0.01 * extent);
    PenetrationDepth d[3];
    for (int k = 0; k < 3; ++k) {
      PosedShape a = pair.a();
      const Vec3 t = a.pose.translation() + k * step;
      a.pose = a.pose.is_quaternion() ? *Pose::from_quaternion(a.pose.quaternion_wxyz(), t)
                                      : Pose::from_trusted_matrix(a.pose.rotation(), t);
      d[k] = penetration_depth(a, pair.b(), scratch);
    }
    const auto value = [](const PenetrationDepth& p) {
      return p.contact == ContactClass::separated ? -p.distance : p.depth;
    };
    // The three translations are equally spaced up to their rounding.
    const double slack = 1e-14 * extent + 1e-15 * pair.a().pose.translation().norm();
    EXPECT_LE(std::abs(value(d[1]) - value(d[0])), step.norm() + slack);
    EXPECT_LE(std::abs(value(d[2]) - value(d[1])), step.norm() + slack);
    // Minus the signed distance to a convex set is concave everywhere: outside, the distance is convex.
    EXPECT_GE(value(d[1]), (value(d[0]) + value(d[2])) / 2 - slack);
  });
}

TEST(Laws, WidthIsTheDepthOfABodyInItself) {
  Scratch scratch;
  for (int f = 0; f < scenes::kPairFamilies; ++f) {
    for (std::uint64_t seed = 1; seed <= 2; ++seed) {
      const PointPair p = scenes::make_pair(static_cast<PairFamily>(f), 12, DepthClass::mid, seed);
      const JudgedPair twice({p.a, p.a, p.pose_a, p.pose_a});
      SCOPED_TRACE(std::string(to_string(static_cast<PairFamily>(f))) + " seed " + std::to_string(seed));
      const Width w = width(twice.a(), scratch);
      const oracle::Verdict& v = twice.verdict();
      if (v.contact == ContactClass::overlapping) {
        EXPECT_EQ(w.lower, v.depth.round_down());
        EXPECT_EQ(w.upper, v.depth.round_up());
      } else {
        EXPECT_EQ(w.lower, 0);
        EXPECT_EQ(w.upper, 0);
      }
    }
  }
}

TEST(Laws, FreshOrUsedScratchAndThreadsGiveTheSameBits) {
  for_each_pair({8}, 1, [](const JudgedPair& pair, Scratch& used) {
    const PenetrationDepth first = penetration_depth(pair.a(), pair.b(), used);
    Scratch fresh;
    expect_same(first, penetration_depth(pair.a(), pair.b(), fresh));
    PenetrationDepth other;
    std::thread([&] {
      Scratch own;
      other = penetration_depth(pair.a(), pair.b(), own);
    }).join();
    expect_same(first, other);
  });
}

}  // namespace
}  // namespace pd
