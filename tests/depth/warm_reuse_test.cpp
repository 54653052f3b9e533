// A shape that dies leaves its address to another: the certificate of the old pair must not be read for the new one.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "pd/depth/penetration_depth.hpp"
#include "pd/depth/scratch.hpp"
#include "pd/depth/warm_certificate.hpp"

namespace {

using pd::ConvexPolytope;
using pd::ConvexShape;
using pd::Pose;
using pd::Vec3;

TEST(Warm, CertificateOfADeadShapeIsRefused) {
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

  // As if the box had been allocated where the other shape was.
  warm.state().shape_a = few.polytope()->x();
  warm.state().shape_b = few.polytope()->x();
  const auto answer = penetration_depth({&few, Pose()}, {&few, pose}, scratch, hot, &warm);
  EXPECT_FALSE(answer.warm);
  EXPECT_EQ(answer.contact, pd::ContactClass::overlapping);
  EXPECT_LE(answer.lower, 1.7);
  EXPECT_GE(answer.upper, 1.7);
}

}  // namespace
