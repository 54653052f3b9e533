/// @file
/// A stranger's program on pd_core alone: two unit cubes, one a quarter deep in the other.
#include <cstdio>
#include <pd/depth/penetration_depth.hpp>
#include <pd/depth/scratch.hpp>
#include <pd/shape/convex_polytope.hpp>

int main() {
  const pd::Expected<pd::ConvexPolytope> cube = pd::ConvexPolytope::box({0.5, 0.5, 0.5});
  const pd::Expected<pd::Pose> aside = pd::Pose::from_matrix(pd::Mat3::Identity(), {0.75, 0, 0});
  if (!cube || !aside) {
    return 1;
  }
  const pd::ConvexShape shape = *cube;
  pd::Scratch scratch;
  const pd::PenetrationDepth answer = pd::penetration_depth({&shape, pd::Pose()}, {&shape, *aside}, scratch);
  std::printf("depth %.17g in [%.17g, %.17g], way out (%g %g %g)\n", answer.depth, answer.lower, answer.upper,
              answer.translation.x(), answer.translation.y(), answer.translation.z());
}
