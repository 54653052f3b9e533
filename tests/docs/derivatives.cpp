#include <cstdio>
#include <pd/depth/derivatives.hpp>
#include <pd/depth/scratch.hpp>

int main() {
  const pd::ConvexShape table = *pd::ConvexPolytope::box({2, 2, 1}), cube = *pd::ConvexPolytope::box({0.5, 0.5, 0.5});
  const pd::PosedShape below{&table, pd::Pose()};
  pd::Scratch scratch;

  // On a corner, which does not lie under the cube's centre: its weight would turn it.
  const pd::Mat3 tilt = Eigen::Quaterniond::FromTwoVectors(pd::Vec3(1, 1, 0.5), pd::Vec3(0, 0, -1)).toRotationMatrix();
  const pd::Pose on_a_corner = *pd::Pose::from_matrix(tilt, {0, 0, 1.75});
  const pd::DepthDerivatives tilted = pd::depth_derivatives({&cube, on_a_corner}, below, scratch);
  std::printf("on a corner: depth %.4f, by its height %.4f, by turns about x %.4f and y %.4f\n", tilted.signed_depth,
              tilted.by_a.translation.z(), tilted.by_a.rotation.x(), tilted.by_a.rotation.y());

  const pd::Pose on_a_face = *pd::Pose::from_matrix(pd::Mat3::Identity(), {0, 0, 1.4});
  const pd::DepthDerivatives flat = pd::depth_derivatives({&cube, on_a_face}, below, scratch);
  std::printf("on a face: one direction %d, one pair of witnesses %d, by a turn about x %f\n", flat.unique_direction,
              flat.unique_witness, flat.by_a.rotation.x());

  const pd::DepthDerivatives inside = pd::depth_derivatives({&cube, pd::Pose()}, {&cube, pd::Pose()}, scratch);
  std::printf("a cube in itself: one direction %d\n", inside.unique_direction);
}
