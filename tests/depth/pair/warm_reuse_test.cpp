// The certificate of one pair must not be read for another.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "depth/expansion/cached_surface.hpp"
#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "pd/depth/warm_certificate.hpp"

namespace {

using pd::ConvexPolytope;
using pd::ConvexShape;
using pd::Pose;
using pd::Vec3;

TEST(Warm, CertificateOfAnotherPairIsRefused) {
  std::vector<Vec3> points;
  for (int i = 0; i < 40; ++i) {
    const double angle = 0.7 * i;
    points.emplace_back(std::cos(angle), std::sin(angle), 0.05 * i - 1);
  }
  const ConvexShape many(ConvexPolytope::from_points(points).value());
  const ConvexShape few(ConvexPolytope::box(Vec3(1, 1, 1)).value());
  const Pose pose = Pose::from_matrix(pd::Mat3::Identity(), Vec3(0.3, 0.2, 0.1)).value();
  pd::Scratch scratch;
  pd::WarmCertificate warm;
  const pd::DepthSettings hot{.bracket = pd::Bracket::certified};
  (void)penetration_depth({&many, Pose()}, {&many, pose}, scratch, hot, &warm);
  ASSERT_FALSE(warm.state().faces.empty());

  // Radii alike, as far as the certificate knows: ids out of range must not be read.
  warm.state().radius_a = warm.state().radius_b = few.polytope()->radius();
  const auto answer = penetration_depth({&few, Pose()}, {&few, pose}, scratch, hot, &warm);
  EXPECT_FALSE(answer.warm);
  EXPECT_EQ(answer.contact, pd::ContactClass::overlapping);
  EXPECT_LE(answer.lower, 1.7);
  EXPECT_GE(answer.upper, 1.7);
}

/// Some brackets take a ball out of a curved core. The points that are kept belong to what is left of it.
TEST(Warm, OneMemoryServesEveryBracket) {
  using pd::Bracket;
  const ConvexShape ellipsoid = *ConvexShape::ellipsoid({3, 1, 2});
  const ConvexShape box(ConvexPolytope::box(Vec3(1, 2, 1)).value());
  const Pose pose = Pose::from_matrix(pd::Mat3::Identity(), Vec3(3, 4, 5)).value();
  pd::Scratch scratch;
  const auto exact = penetration_depth({&ellipsoid, Pose()}, {&box, pose}, scratch);
  pd::WarmCertificate warm;
  for (const Bracket bracket : {Bracket::contact, Bracket::certified, Bracket::contact, Bracket::tightest}) {
    const auto answer = penetration_depth({&ellipsoid, Pose()}, {&box, pose}, scratch, {.bracket = bracket}, &warm);
    EXPECT_LE(answer.distance_lower, exact.distance_upper);
    EXPECT_GE(answer.distance_upper, exact.distance_lower);
    EXPECT_LE(answer.distance_lower, answer.distance_upper);
  }
}

}  // namespace
