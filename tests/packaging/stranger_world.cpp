/// @file
/// A stranger's program on engine_glue: a Bullet world whose contacts come from pdepth. The page on Bullet shows it.
#include <btBulletDynamicsCommon.h>

#include <cstdio>
#include <pd/bullet/install.hpp>

int main() {
  pd::BulletPenetrationDepthSolver solver;  // if it dies first, Bullet's own EPA goes on
  btBoxShape table(btVector3(1, 1, 1)), die(btVector3(0.1f, 0.1f, 0.1f));
  btRigidBody below(0, nullptr, &table), above(1, nullptr, &die, btVector3(0.01f, 0.01f, 0.01f));
  above.setWorldTransform(btTransform(btQuaternion::getIdentity(), btVector3(0, 1.09f, 0)));

  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver impulses;
  btDiscreteDynamicsWorld world(&dispatcher, &broadphase, &impulses, &configuration);
  pd::install(world, solver);  // every pair of convex shapes, from the next step on

  world.addRigidBody(&below);
  world.addRigidBody(&above);
  for (int step = 0; step < 240; ++step) world.stepSimulation(1.0f / 240, 0);
  std::printf("%lld exact answers, the die rests at %.2f\n", static_cast<long long>(solver.statistics().calls),
              double(above.getWorldTransform().getOrigin().y()));
}
