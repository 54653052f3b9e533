/// @file
/// A stranger's program on engine_glue: the same two cubes, as Bullet shapes at Bullet's transforms.
#include <BulletCollision/CollisionShapes/btBoxShape.h>

#include <cstdio>
#include <pd/bullet/scalar.hpp>
#include <pd/bullet/shape_conversion.hpp>
#include <pd/depth/penetration_depth.hpp>
#include <pd/depth/scratch.hpp>

int main() {
  btBoxShape box(btVector3(btScalar(0.5), btScalar(0.5), btScalar(0.5)));
  box.setMargin(0);
  const btTransform aside(btMatrix3x3::getIdentity(), btVector3(btScalar(0.75), 0, 0));
  const pd::Expected<pd::ConvexShape> shape = pd::to_convex_shape(box);
  if (!shape) {
    return 1;
  }
  pd::Scratch scratch;
  const pd::PenetrationDepth answer =
      pd::penetration_depth({&*shape, pd::Pose()}, {&*shape, pd::to_pd(aside)}, scratch);
  std::printf("depth %.17g, scalar of %zu bytes\n", answer.depth, sizeof(btScalar));
}
