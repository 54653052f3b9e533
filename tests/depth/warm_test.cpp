/// @file
/// Warm certificates: whatever moved in between, the answer keeps every promise, and the same calls give the same bits.

#include <gtest/gtest.h>

#include "oracle/judged_pair.hpp"
#include "pd/depth/warm_certificate.hpp"

namespace pd {
namespace {

using oracle::JudgedPair;
using scenes::DepthClass;
using scenes::PairFamily;

/// Frame k of a sequence: B turns about a fixed axis and drifts.
scenes::PointPair frame(const scenes::PointPair& start, int k, double angle, double drift) {
  scenes::PointPair p = start;
  if (!p.pose_b.is_quaternion()) return p;
  scenes::Random random(99);
  const Vec3 axis = random.direction();
  const Vec3 along = random.direction();
  const double s = angle * k / 2;
  const double w = 1 / std::sqrt(1 + s * s);
  const double r[4] = {w, w * s * axis.x(), w * s * axis.y(), w * s * axis.z()};
  const auto& q = p.pose_b.quaternion_wxyz();
  const std::array<double, 4> product = {
      r[0] * q[0] - r[1] * q[1] - r[2] * q[2] - r[3] * q[3], r[0] * q[1] + r[1] * q[0] + r[2] * q[3] - r[3] * q[2],
      r[0] * q[2] - r[1] * q[3] + r[2] * q[0] + r[3] * q[1], r[0] * q[3] + r[1] * q[2] - r[2] * q[1] + r[3] * q[0]};
  p.pose_b = *Pose::from_quaternion(product, p.pose_b.translation() + k * drift * along);
  return p;
}

TEST(Warm, KeepsEveryPromiseFrameByFrameAndRepeatsItself) {
  Scratch scratch;
  int warm_answers = 0;
  int frames = 0;
  for (const PairFamily family : {PairFamily::box, PairFamily::sphere, PairFamily::needle, PairFamily::prism,
                                  PairFamily::slivers, PairFamily::clouds, PairFamily::equal_bodies}) {
    for (const double angle : {0.002, 0.05}) {
      for (const DepthClass depth : {DepthClass::shallow, DepthClass::mid, DepthClass::deep}) {
        const scenes::PointPair start = scenes::make_pair(family, 16, depth, 11);
        WarmCertificate first;
        WarmCertificate second;
        for (int k = 0; k < 12; ++k) {
          const JudgedPair pair(frame(start, k, angle, 0.003),
                                std::string(to_string(family)) + " frame " + std::to_string(k));
          const PenetrationDepth warm =
              penetration_depth(pair.a(), pair.b(), scratch, {.bracket = Bracket::certified}, &first);
          {
            const std::string complaint = pair.complaint(warm, Bracket::certified);
            ASSERT_TRUE(complaint.empty()) << complaint;
          }
          const PenetrationDepth again =
              penetration_depth(pair.a(), pair.b(), scratch, {.bracket = Bracket::certified}, &second);
          ASSERT_EQ(warm.depth, again.depth);
          ASSERT_EQ(warm.translation, again.translation);
          ASSERT_EQ(warm.lower, again.lower);
          const PenetrationDepth cold = penetration_depth(pair.a(), pair.b(), scratch);
          ASSERT_EQ(warm.contact, cold.contact);
          ASSERT_LE(warm.lower, cold.upper);
          ASSERT_GE(warm.upper, cold.lower);
          warm_answers += warm.warm;
          ++frames;
        }
      }
    }
  }
  std::printf("%d of %d frames answered warm\n", warm_answers, frames);
}

TEST(Warm, SurvivesJumpsAndOtherPairs) {
  Scratch scratch;
  WarmCertificate certificate;
  for (int f = 0; f < scenes::kPairFamilies; ++f) {
    for (int d = 0; d < scenes::kDepthClasses; ++d) {
      const JudgedPair pair = JudgedPair::of_family(static_cast<PairFamily>(f), 10, static_cast<DepthClass>(d), 21);
      const PenetrationDepth answer =
          penetration_depth(pair.a(), pair.b(), scratch, {.bracket = Bracket::certified}, &certificate);
      {
        const std::string complaint = pair.complaint(answer, Bracket::certified);
        ASSERT_TRUE(complaint.empty()) << complaint;
      }
    }
  }
}

TEST(Warm, StaysSmall) {
  Scratch scratch;
  WarmCertificate certificate;
  const JudgedPair pair = JudgedPair::of_family(PairFamily::sphere, 512, DepthClass::deep, 1);
  (void)penetration_depth(pair.a(), pair.b(), scratch, {.bracket = Bracket::certified}, &certificate);
  EXPECT_LT(certificate.memory_bytes(), 4096);
  certificate.clear();
  (void)penetration_depth(pair.a(), pair.b(), scratch, {.bracket = Bracket::certified}, &certificate);
}

}  // namespace
}  // namespace pd
