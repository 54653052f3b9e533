/// @file
/// The sample of the page on C++, compiled and run.
// [library]
#include <cstdio>
#include <pd/depth/penetration_depth.hpp>
#include <pd/depth/scratch.hpp>

int main() {
  const pd::ConvexShape cube = *pd::ConvexPolytope::box({0.5, 0.5, 0.5});
  const pd::Pose aside = *pd::Pose::from_matrix(pd::Mat3::Identity(), {0.75, 0, 0});
  pd::Scratch scratch;  // one per thread; nothing is allocated once it has grown
  const pd::PenetrationDepth answer = pd::penetration_depth({&cube, pd::Pose()}, {&cube, aside}, scratch);
  std::printf("depth %.2f, A moves by %.2f along x\n", answer.depth, answer.translation.x());
}
// [/library]
