// Two bodies that are proved to be still apart are, and bodies that move together stay proved.
#include "pd/union_contact/parted_pieces.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "pd/contact/time_of_impact.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"

namespace pd::test {
namespace {

class Poses {
 public:
  double number() { return 2 * std::generate_canonical<double, 53>(random_) - 1; }
  Vec3 vector() {
    const double x = number(), y = number();
    return {x, y, number()};
  }
  Mat3 turn(double angle) { return Eigen::AngleAxisd(angle * number(), vector().normalized()).toRotationMatrix(); }
  /// A host's pose in single precision, whose matrix is a rotation only up to its rounding.
  static Pose rounded(const Mat3& rotation, const Vec3& place) {
    return Pose::from_trusted_matrix(rotation.cast<float>().cast<double>(), place.cast<float>().cast<double>());
  }

 private:
  std::mt19937_64 random_{11};
};

TEST(PartedPieces, WhatIsProvedHolds) {
  Poses random;
  Scratch scratch;
  std::vector<Vec3> points;
  for (int i = 0; i < 12; ++i) points.push_back(0.4 * random.vector());
  const ConvexShape shapes[] = {ConvexShape(*ConvexPolytope::box({0.3, 0.04, 0.04})),
                                *ConvexShape(*ConvexPolytope::from_points(points)).with_margin(0.05),
                                *ConvexShape::cylinder(0.2, 0.4, 1), *ConvexShape::cone(0.3, 0.3, 2)};
  int apart = 0, proved = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    SCOPED_TRACE(trial);
    const ConvexShape &a = shapes[trial % 4], &b = shapes[(trial / 4) % 4];
    const Vec3 world = 100 * random.vector();
    const Mat3 turn_a = random.turn(3), turn_b = random.turn(3);
    const Vec3 place_a = world + 0.7 * random.vector(), place_b = world + 0.7 * random.vector();
    const Pose pose_a = Poses::rounded(turn_a, place_a), pose_b = Poses::rounded(turn_b, place_b);
    DepthSettings settings;
    settings.bracket = Bracket::contact;
    settings.beyond = 0.01;
    const PenetrationDepth answer = penetration_depth({&a, pose_a}, {&b, pose_b}, scratch, settings);
    PartedPieces parted;
    parted.note(pose_a, pose_b, answer);
    ASSERT_EQ(parted.known(), answer.contact == ContactClass::separated);
    if (!parted.known()) continue;
    ++apart;
    const double radius = bounding_radius(a);
    EXPECT_TRUE(parted.beyond(0.99 * answer.distance_lower - 1e-4, pose_a, pose_b, radius));
    for (int step = 0; step < 5; ++step) {
      // Both move by metres together, and A by centimetres.
      const Mat3 common = random.turn(1), own = random.turn(0.2);
      const Vec3 way = random.vector();
      const Pose now_a =
          Poses::rounded(common * own * turn_a, world + way + common * (place_a - world + 0.1 * random.vector()));
      const Pose now_b = Poses::rounded(common * turn_b, world + way + common * (place_b - world));
      const double gap = 0.02 * std::abs(random.number());
      if (!parted.beyond(gap, now_a, now_b, radius)) continue;
      ++proved;
      EXPECT_GT(penetration_depth({&a, now_a}, {&b, now_b}, scratch).signed_distance(), gap);
    }
  }
  EXPECT_GT(apart, 500);
  EXPECT_GT(proved, 2 * apart);
}

TEST(PartedPieces, ComesNearerOnlyAcrossThePlane) {
  const ConvexShape box{*ConvexPolytope::box({1, 1, 1})};
  const auto at = [](double x, double y) { return Pose::from_trusted_matrix(Mat3::Identity(), Vec3(x, y, 0)); };
  Scratch scratch;
  const PenetrationDepth answer = penetration_depth({&box, at(3, 0)}, {&box, at(0, 0)}, scratch);
  PartedPieces parted;
  EXPECT_FALSE(parted.known());
  parted.note(at(3, 0), at(0, 0), answer);
  EXPECT_TRUE(parted.beyond(0.5, at(3, 9), at(0, 0), 2));
  EXPECT_TRUE(parted.beyond(0.5, at(2.6, 0), at(0, 0), 2));
  EXPECT_FALSE(parted.beyond(0.5, at(2.4, 0), at(0, 0), 2));
  EXPECT_TRUE(parted.beyond(0.5, at(2.4, 0), at(-0.2, 0), 2));
  parted.forget();
  EXPECT_FALSE(parted.known());
}

}  // namespace
}  // namespace pd::test
