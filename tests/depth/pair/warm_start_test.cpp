/// @file
/// Warm certificates: whatever moved in between, the answer keeps every promise, and the same calls give the same bits.

#include <gtest/gtest.h>

#include <cstdlib>

#include "depth/expansion/cached_surface.hpp"
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

/// Rides of each kind of small solids; PD_SMALL_RIDES asks for more.
std::uint64_t small_seeds() {
  const char* const asked = std::getenv("PD_SMALL_RIDES");
  return asked ? std::strtoull(asked, nullptr, 10) : 2;
}

/// Frames of the same two bodies, each judged and compared with a second memory that took the same way.
struct Ride {
  int frames = 0;
  int warm = 0;
  std::int64_t supports = 0;
};
Ride ride(PairFamily family, int n, DepthClass depth, std::uint64_t seed, double angle, double drift, int frames) {
  const scenes::PointPair start = scenes::make_pair(family, n, depth, seed);
  const JudgedPair bodies(start, "");
  Scratch scratch;
  WarmCertificate first;
  WarmCertificate second;
  Ride out;
  for (int k = 0; k < frames; ++k) {
    const JudgedPair pair(frame(start, k, angle, drift),
                          std::string(to_string(family)) + " frame " + std::to_string(k));
    const PosedShape a{bodies.a().shape, pair.a().pose};
    const PosedShape b{bodies.b().shape, pair.b().pose};
    const PenetrationDepth answer = penetration_depth(a, b, scratch, {.bracket = Bracket::certified}, &first);
    const std::string complaint = pair.complaint(answer, Bracket::certified);
    EXPECT_TRUE(complaint.empty()) << complaint;
    const PenetrationDepth again = penetration_depth(a, b, scratch, {.bracket = Bracket::certified}, &second);
    EXPECT_EQ(answer.translation, again.translation);
    EXPECT_EQ(answer.lower, again.lower);
    EXPECT_EQ(answer.distance, again.distance);
    EXPECT_EQ(answer.witness_a, again.witness_a);
    if (k == 0) continue;
    ++out.frames;
    out.warm += answer.warm;
    out.supports += answer.statistics.support_calls;
  }
  return out;
}

TEST(Warm, AsksForOneSupportWhileBodiesMoveSlowly) {
  for (const PairFamily family : {PairFamily::sphere, PairFamily::prism, PairFamily::clouds}) {
    for (const DepthClass depth : {DepthClass::shallow, DepthClass::mid}) {
      const Ride slow = ride(family, 24, depth, 3, 0.0005, 1e-5, 40);
      EXPECT_EQ(slow.warm, slow.frames) << to_string(family);
      EXPECT_LE(slow.supports, slow.frames + 8) << to_string(family);
      const Ride fast = ride(family, 24, depth, 3, 0.08, 0.01, 30);
      EXPECT_GT(10 * fast.warm, 8 * fast.frames) << to_string(family);
      // Growing anew takes ten supports and more.
      EXPECT_LE(fast.supports, 6 * fast.frames) << to_string(family);
    }
  }
}

TEST(Warm, SmallSolidsGoOnFromTheirSurface) {
  int frames = 0, warm = 0;
  for (const PairFamily family : {PairFamily::sphere, PairFamily::needle, PairFamily::slivers, PairFamily::clouds,
                                  PairFamily::prism, PairFamily::tilted_roofs, PairFamily::roofs, PairFamily::grid,
                                  PairFamily::parallel_edges, PairFamily::equal_bodies, PairFamily::single_precision,
                                  PairFamily::near_kissing, PairFamily::near_equal_bodies, PairFamily::ulp_noise}) {
    for (const DepthClass depth : {DepthClass::shallow, DepthClass::mid, DepthClass::deep}) {
      for (const double angle : {0.001, 0.01, 0.06}) {
        for (std::uint64_t seed = 1; seed <= small_seeds(); ++seed) {
          const Ride of = ride(family, 8, depth, seed, angle, angle / 20, 24);
          frames += of.frames;
          warm += of.warm;
          if (family != PairFamily::sphere || angle > 0.002 || seed > 2) continue;
          EXPECT_GE(of.warm, of.frames - 4);
          EXPECT_LE(of.supports, of.frames + 8);
        }
      }
    }
  }
  EXPECT_GT(10 * warm, 5 * frames);
  std::printf("%d of %d frames answered warm\n", warm, frames);
}

TEST(Warm, BodiesApartAreMetWhereTheyWere) {
  for (const PairFamily family : {PairFamily::box, PairFamily::sphere, PairFamily::prism, PairFamily::needle}) {
    const Ride apart = ride(family, 24, DepthClass::gap, 7, 0.01, 0.002, 30);
    EXPECT_EQ(apart.warm, apart.frames) << to_string(family);
    // One looks at the far side, one confirms; GJK from scratch takes eight and more.
    EXPECT_LE(apart.supports, 4 * apart.frames) << to_string(family);
  }
}

TEST(Warm, SurfacesOfOtherBodiesAreNotBelieved) {
  // The other pair is told to have as many vertices and the same size, so that the surface is tried.
  const JudgedPair pair = JudgedPair::of_family(PairFamily::sphere, 24, DepthClass::mid, 5);
  const JudgedPair other = JudgedPair::of_family(PairFamily::sphere, 24, DepthClass::mid, 6);
  Scratch scratch;
  WarmCertificate certificate;
  const DepthSettings hot{.bracket = Bracket::certified};
  PenetrationDepth answer;
  for (int k = 0; k < 3; ++k) answer = penetration_depth(pair.a(), pair.b(), scratch, hot, &certificate);
  ASSERT_TRUE(answer.warm);
  certificate.state().vertices_a = other.a().shape->polytope()->num_vertices();
  certificate.state().vertices_b = other.b().shape->polytope()->num_vertices();
  certificate.state().radius_a = other.a().shape->polytope()->radius();
  certificate.state().radius_b = other.b().shape->polytope()->radius();
  answer = penetration_depth(other.a(), other.b(), scratch, hot, &certificate);
  const std::string complaint = other.complaint(answer, Bracket::certified);
  EXPECT_TRUE(complaint.empty()) << complaint;
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
