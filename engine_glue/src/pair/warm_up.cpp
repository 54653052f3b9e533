#include "pair/warm_up.hpp"

#include <array>

#include "pd/contact/manifold.hpp"
#include "pd/depth/penetration_depth.hpp"

namespace pd::detail {

namespace {

/// More than eight corners, so that no closed form answers.
ConvexShape many_cornered() {
  std::array<Vec3, 10> corners;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const double t = 0.1 * static_cast<double>(i);
    corners[i] = Vec3(t * (1 - t), t * t, i % 2 == 0 ? 1 : -1) + t * Vec3(0.3, 0.1, 0.2);
  }
  return *ConvexPolytope::from_points(corners);
}

}  // namespace

void warm_up(ThreadBuffers& buffers) {
  static const ConvexShape hull = many_cornered(), box = *ConvexPolytope::box({1, 2, 1}),
                           cylinder = *ConvexShape::cylinder(1, 1, 2);
  DepthSettings settings;
  settings.bracket = Bracket::contact;
  const auto ask = [&](const ConvexShape& a, const ConvexShape& b, const Vec3& way) {
    const PosedShape posed_a{&a, Pose()}, posed_b{&b, Pose::from_trusted_matrix(Mat3::Identity(), way)};
    const PenetrationDepth depth = penetration_depth(posed_a, posed_b, buffers.scratch, settings);
    (void)contact_manifold(posed_a, posed_b, depth, 1, buffers.manifold, DeepestPoint::as_lifted);
  };
  ask(hull, hull, {0.05, 0.02, 0.01});  // deep
  ask(cylinder, box, {0.1, 0.2, 1.9});  // a disc on a face
}

}  // namespace pd::detail
