// Contact points of two boxes in one pass, against the general query and its manifold.
#include "pd/contact/box_contact.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include "pd/depth/scratch.hpp"

namespace {

using pd::BoxContact;
using pd::ContactClass;
using pd::ContactManifold;
using pd::ConvexPolytope;
using pd::ConvexShape;
using pd::Mat3;
using pd::Pose;
using pd::Vec3;

constexpr double kThreshold = 0.02;
constexpr double kTolerance = 0x1p-30;

struct Boxes {
  Vec3 half_a, half_b;
  Pose pose_a, pose_b;

  [[nodiscard]] BoxContact contact(double threshold = kThreshold) const {
    return pd::box_contact({half_a, &pose_a}, {half_b, &pose_b}, kTolerance, threshold);
  }
};

/// The same by polytopes, with the tightest bracket and with that of contacts.
struct General {
  ConvexShape a, b;
  pd::PenetrationDepth tightest, answer;
  ContactManifold manifold;

  explicit General(const Boxes& boxes) : a(*ConvexPolytope::box(boxes.half_a)), b(*ConvexPolytope::box(boxes.half_b)) {
    pd::Scratch scratch;
    pd::ManifoldScratch buffers;
    const pd::PosedShape posed_a{&a, boxes.pose_a}, posed_b{&b, boxes.pose_b};
    tightest = pd::penetration_depth(posed_a, posed_b, scratch);
    pd::DepthSettings settings;
    settings.bracket = pd::Bracket::contact;
    settings.contact_tolerance = kTolerance;
    answer = pd::penetration_depth(posed_a, posed_b, scratch, settings);
    manifold = pd::contact_manifold(posed_a, posed_b, answer, kThreshold, buffers, pd::DeepestPoint::as_lifted);
  }
};

/// A rotation rounded to the numbers of an engine in single precision.
Mat3 single(const Mat3& rotation) { return rotation.cast<float>().cast<double>(); }

/// Two boxes near contact: turned anyhow, or resting on each other up to the noise of single precision.
Boxes draw(bool resting, std::mt19937_64& random) {
  std::uniform_real_distribution<double> extent(0.1, 1), share(-1, 1);
  std::normal_distribution<double> normal;
  const auto vector = [&](auto& distribution) {
    const double z = distribution(random), y = distribution(random);
    return Vec3(distribution(random), y, z);
  };
  /// A turn about a random axis, which is drawn before the angle.
  const auto turned = [&](double scale, auto& distribution) {
    const Vec3 axis = vector(normal).normalized();
    return Mat3(Eigen::AngleAxisd(scale * distribution(random), axis).matrix());
  };
  const Vec3 half_a = vector(extent), half_b = vector(extent);
  if (!resting) {
    const Mat3 of_a = turned(3, share), of_b = turned(3, share);
    const Vec3 way = vector(normal).normalized();
    const double reach =
        (of_a.transpose() * way).cwiseAbs().dot(half_a) + (of_b.transpose() * way).cwiseAbs().dot(half_b);
    const Vec3 at = vector(normal);
    return {half_a, half_b, Pose::from_trusted_matrix(single(of_a), at),
            Pose::from_trusted_matrix(single(of_b), at + (reach * (0.8 + 0.1 * share(random))) * way)};
  }
  const auto noise = [&] { return turned(1e-7, normal); };
  const Mat3 turn = Eigen::AngleAxisd(share(random), Vec3::UnitY()).matrix();
  const Vec3 over =
      Vec3(0, half_a.y() + half_b.y(), 0) + vector(share).cwiseProduct(Vec3(half_b.x(), 1e-3, half_b.z()));
  return {half_a, half_b, Pose::from_trusted_matrix(single(noise() * turn), over),
          Pose::from_trusted_matrix(single(noise()), Vec3::Zero())};
}

/// How far the points of one manifold lie from those of another, at most.
double gap(const ContactManifold& x, const ContactManifold& y) {
  double most = 0;
  for (int i = 0; i < x.count; ++i) {
    double least = HUGE_VAL;
    for (int k = 0; k < y.count; ++k) {
      least = std::min(least, (x.points[i].position_b - y.points[k].position_b).norm() +
                                  std::abs(x.points[i].depth - y.points[k].depth));
    }
    most = std::max(most, least);
  }
  return most;
}

std::set<std::int64_t> ids(const ContactManifold& manifold) {
  std::set<std::int64_t> all;
  for (int i = 0; i < manifold.count; ++i) all.insert(manifold.points[i].feature_id);
  return all;
}

class BoxContacts : public ::testing::TestWithParam<bool> {};

TEST_P(BoxContacts, AreThoseOfTheGeneralQuery) {
  std::mt19937_64 random(31);
  int answered = 0, with_points = 0, same_normal = 0, same_points = 0;
  constexpr int kPairs = 4000;
  for (int i = 0; i < kPairs; ++i) {
    const Boxes boxes = draw(GetParam(), random);
    const BoxContact found = boxes.contact();
    if (!found.answered) continue;
    ++answered;
    const General general(boxes);
    const pd::PenetrationDepth& exact = general.tightest;
    const bool overlap = exact.contact == ContactClass::overlapping;
    EXPECT_LE(found.lower, overlap ? -exact.lower : exact.distance_upper) << i;
    if (found.manifold.count == 0) {
      EXPECT_GT(exact.distance_upper, kThreshold) << i;
      continue;
    }
    ++with_points;
    EXPECT_GE(found.upper, overlap ? -exact.upper : exact.distance_lower) << i;
    EXPECT_LE(found.upper - found.lower, kTolerance) << i;
    EXPECT_EQ(found.contact, general.answer.contact) << i;
    EXPECT_NEAR(found.manifold.normal.norm(), 1, 1e-15) << i;
    for (int k = 0; k < found.manifold.count; ++k) {
      const pd::ContactPoint& point = found.manifold.points[k];
      EXPECT_NEAR((point.position_b - point.position_a - point.depth * found.manifold.normal).norm(), 0, 1e-14) << i;
      EXPECT_LE(point.depth, -found.lower + 1e-15) << i;
      EXPECT_GE(point.depth, -kThreshold) << i;
    }
    // Of two ways out that are equal but for rounding either is taken.
    if ((found.manifold.normal - general.answer.normal).norm() > 1e-12) continue;
    ++same_normal;
    EXPECT_EQ(found.manifold.count, general.manifold.count) << i;
    // Four of more corners are chosen by areas, which may be equal but for rounding.
    if (found.manifold.count == 4 && ids(found.manifold) != ids(general.manifold)) continue;
    ++same_points;
    // Columns of a rotation in single precision are at right angles up to 1e-7.
    EXPECT_LE(gap(found.manifold, general.manifold), 1e-6) << i;
    EXPECT_LE(gap(general.manifold, found.manifold), 1e-6) << i;
    EXPECT_EQ(ids(found.manifold), ids(general.manifold)) << i;
    EXPECT_EQ(static_cast<int>(ids(found.manifold).size()), found.manifold.count) << i;
  }
  EXPECT_GE(answered, kPairs * 95 / 100);
  EXPECT_GE(with_points, kPairs / 4);
  EXPECT_GE(same_normal, with_points * 95 / 100);
  EXPECT_GE(same_points, same_normal * 98 / 100);
}

INSTANTIATE_TEST_SUITE_P(Ways, BoxContacts, ::testing::Values(false, true),
                         [](const auto& ways) { return ways.param ? "Resting" : "AnyTurn"; });

TEST(BoxContact, BrickOverTwoBricksHasFourPointsWithTheSameIdsUnderNoise) {
  const Vec3 half(0.5, 0.25, 0.25);
  const Boxes exact{half, half, Pose::from_trusted_matrix(Mat3::Identity(), Vec3(0.5, 0.4999, 0)), Pose()};
  const BoxContact found = exact.contact();
  ASSERT_TRUE(found.answered);
  EXPECT_EQ(found.contact, ContactClass::overlapping);
  EXPECT_NEAR(found.upper, -1e-4, 1e-14);
  ASSERT_EQ(found.manifold.count, 4);
  for (int k = 0; k < 4; ++k) {
    const Vec3& on_b = found.manifold.points[k].position_b;
    EXPECT_TRUE(std::abs(on_b.x()) < 1e-12 || std::abs(on_b.x() - 0.5) < 1e-12) << on_b.transpose();
    EXPECT_NEAR(on_b.y(), 0.25, 1e-15);
    EXPECT_NEAR(std::abs(on_b.z()), 0.25, 1e-12);
    EXPECT_NEAR(found.manifold.points[k].depth, 1e-4, 1e-15);
  }
  EXPECT_EQ(ids(found.manifold).size(), 4u);
}

TEST(BoxContact, FlushCubesTurnedAgainstEachOtherKeepFourOfEightPoints) {
  const Vec3 half(0.5, 0.5, 0.5);
  const Mat3 turn = Eigen::AngleAxisd(M_PI / 4, Vec3::UnitY()).matrix();
  const Boxes boxes{half, half, Pose::from_trusted_matrix(turn, Vec3(0, 0.999, 0)), Pose()};
  const BoxContact found = boxes.contact();
  ASSERT_TRUE(found.answered);
  EXPECT_EQ(found.manifold.count, 4);
  EXPECT_EQ(ids(found.manifold).size(), 4u);
}

TEST(BoxContact, CrossedEdgesMeetInOnePoint) {
  const Vec3 half(0.5, 0.5, 0.5);
  const Mat3 on_x = Eigen::AngleAxisd(M_PI / 4, Vec3::UnitX()).matrix();
  const Mat3 on_z = Eigen::AngleAxisd(M_PI / 4, Vec3::UnitZ()).matrix();
  const Boxes boxes{half, half, Pose::from_trusted_matrix(on_x, Vec3(0.1, std::sqrt(2.0) - 1e-3, 0.2)),
                    Pose::from_trusted_matrix(on_z, Vec3::Zero())};
  const BoxContact found = boxes.contact();
  ASSERT_TRUE(found.answered);
  ASSERT_EQ(found.manifold.count, 1);
  EXPECT_NEAR(found.manifold.normal.y(), 1, 1e-12);
  EXPECT_NEAR(found.manifold.points[0].depth, 1e-3, 1e-12);
  EXPECT_NEAR((found.manifold.points[0].position_b - Vec3(0, std::sqrt(0.5), 0.2)).norm(), 0, 1e-12);
}

TEST(BoxContact, FartherApartThanTheThresholdHasNoPoints) {
  const Vec3 half(1, 1, 1);
  const Boxes boxes{half, half, Pose::from_trusted_matrix(Mat3::Identity(), Vec3(0.3, 2.03, 0.1)), Pose()};
  const BoxContact found = boxes.contact();
  ASSERT_TRUE(found.answered);
  EXPECT_EQ(found.contact, ContactClass::separated);
  EXPECT_EQ(found.manifold.count, 0);
  EXPECT_GT(found.lower, kThreshold);
  EXPECT_EQ(boxes.contact(0.04).manifold.count, 4);
}

TEST(BoxContact, TouchingBoxesAreSaidToTouch) {
  const Vec3 half(1, 1, 1);
  const Boxes boxes{half, half, Pose::from_trusted_matrix(Mat3::Identity(), Vec3(0.5, 2, 0.25)), Pose()};
  const BoxContact found = boxes.contact();
  ASSERT_TRUE(found.answered);
  EXPECT_EQ(found.contact, ContactClass::touching);
  EXPECT_LE(found.lower, 0);
  EXPECT_GE(found.upper, 0);
  ASSERT_EQ(found.manifold.count, 4);
  for (int k = 0; k < 4; ++k) EXPECT_NEAR(found.manifold.points[k].depth, 0, 1e-14);
}

TEST(BoxContact, DepthIsThatOfTheGeneralQuery) {
  std::mt19937_64 random(57);
  pd::Scratch scratch;
  int apart = 0, near = 0;
  for (int i = 0; i < 500; ++i) {
    Boxes boxes = draw(i % 2 == 0, random);
    if (i % 5 == 0) {
      boxes.pose_a = Pose::from_trusted_matrix(boxes.pose_a.rotation(), boxes.pose_a.translation() + Vec3(0, 5, 0));
    }
    const BoxContact found = pd::box_contact({boxes.half_a, &boxes.pose_a}, {boxes.half_b, &boxes.pose_b}, kTolerance,
                                             kThreshold, pd::BoxWitness::placed);
    if (!found.answered) continue;
    const pd::PenetrationDepth depth = pd::depth_of(found);
    const General general(boxes);
    EXPECT_EQ(depth.contact, general.answer.contact) << i;
    const double exact = general.tightest.signed_distance();
    if (depth.contact == ContactClass::overlapping) {
      EXPECT_LE(depth.lower, -exact + 1e-15) << i;
      EXPECT_GE(depth.upper, -exact - 1e-15) << i;
    } else if (depth.contact == ContactClass::separated) {
      EXPECT_LE(depth.distance_lower, exact + 1e-15) << i;
      EXPECT_GE(depth.distance_upper, exact - 1e-15) << i;
      EXPECT_GE(depth.distance, depth.distance_lower) << i;
      EXPECT_LE(depth.distance, depth.distance_upper) << i;
    }
    if (found.manifold.count == 0) {
      ++apart;
      EXPECT_GT(depth.signed_distance(), kThreshold) << i;
      EXPECT_TRUE(std::isfinite(depth.distance_upper)) << i;
      continue;
    }
    ++near;
    EXPECT_NEAR((depth.witness_a - depth.witness_b).dot(depth.normal), depth.signed_distance(), 2 * kTolerance) << i;
    for (const bool of_a : {true, false}) {
      const Pose& pose = of_a ? boxes.pose_a : boxes.pose_b;
      const Vec3& witness = of_a ? depth.witness_a : depth.witness_b;
      const Vec3 local = pose.rotation().transpose() * (witness - pose.translation());
      EXPECT_LE((local.cwiseAbs() - (of_a ? boxes.half_a : boxes.half_b)).maxCoeff(), 1e-6) << i;
    }
  }
  EXPECT_GE(apart, 90);
  EXPECT_GE(near, 100);
}

TEST(BoxContact, BracketsHoldForPosesOfDoublePrecision) {
  std::mt19937_64 random(71);
  std::normal_distribution<double> normal;
  int with_points = 0, apart = 0;
  for (int i = 0; i < 3000; ++i) {
    Boxes boxes = draw(i % 2 == 0, random);
    // Products of such columns round; edges of both boxes are parallel but for 1e-9 or 1e-13, or stand anyhow.
    const double noise = i % 3 == 0 ? 1e-9 : i % 3 == 1 ? 1e-13 : 1e-2;
    for (Pose* pose : {&boxes.pose_a, &boxes.pose_b}) {
      const double angle = noise * normal(random);
      const Vec3 axis{normal(random), normal(random), normal(random)};
      const Mat3 turn = Eigen::AngleAxisd(angle, axis.normalized()).matrix();
      *pose = Pose::from_trusted_matrix(turn * pose->rotation(), pose->translation());
    }
    const BoxContact found = boxes.contact();
    if (!found.answered) continue;
    const pd::PenetrationDepth exact = General(boxes).tightest;
    const bool overlap = exact.contact == ContactClass::overlapping;
    ASSERT_LE(found.lower, overlap ? -exact.lower : exact.distance_upper) << i;
    if (found.manifold.count == 0) {
      ++apart;
      continue;
    }
    ++with_points;
    ASSERT_GE(found.upper, overlap ? -exact.upper : exact.distance_lower) << i;
    ASSERT_LE(found.upper - found.lower, kTolerance) << i;
  }
  EXPECT_GT(with_points, 1000);
  EXPECT_GT(apart, 100);
}

TEST(BoxContact, LeavesSizesOutOfRangeToTheGeneralQuery) {
  const Pose pose;
  for (const Vec3& half : {Vec3(0, 1, 1), Vec3(1e-40, 1, 1), Vec3(1e40, 1, 1), Vec3(NAN, 1, 1)}) {
    EXPECT_FALSE(pd::box_contact({half, &pose}, {Vec3(1, 1, 1), &pose}, kTolerance, kThreshold).answered)
        << half.transpose();
  }
}

}  // namespace
