// A client of Bullet that is compiled as C++14, as Bullet's own examples are: the headers that it includes have to
// parse.
#include <btBulletDynamicsCommon.h>

#include <pd/bullet/contact_recorder.hpp>
#include <pd/bullet/install.hpp>
#include <pd/bullet/penetration_depth_solver.hpp>
#include <pd/bullet/rollback.hpp>
#include <pd/bullet/snapshot.hpp>
#include <pd/bullet/solver_settings.hpp>
#include <pd/bullet/stack_solver.hpp>

#if __cplusplus >= 201703L
#error "this source is to be compiled as C++14"
#endif

/// Where a cube of 2 m that is let go on a floor is after a second.
double height_in_cpp14() {
  pd::BulletSolverSettings settings;
  settings.warning = nullptr;
  pd::BulletPenetrationDepthSolver solver(settings);
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  pd::StackSolver impulses;
  btDiscreteDynamicsWorld world(&dispatcher, &broadphase, &impulses, &configuration);
  pd::install(world, solver);
  pd::apply_recommended(world.getSolverInfo());
  btBoxShape box(btVector3(1, 1, 1));
  btRigidBody floor(0, nullptr, &box), cube(1, nullptr, &box, btVector3(1, 1, 1));
  btTransform pose = btTransform::getIdentity();
  pose.setOrigin(btVector3(0, btScalar(2.05), 0));
  cube.setWorldTransform(pose);
  world.addRigidBody(&floor);
  world.addRigidBody(&cube);
  pd::prepare(world, solver);
  pd::RollbackStepper stepper(world, solver);
  const pd::BulletSnapshot start(world, &solver);
  double height = 0;
  for (int round = 0; round < 2; ++round) {
    for (int i = 0; i < 60; ++i) stepper.step(btScalar(1) / 60);
    height = static_cast<double>(cube.getWorldTransform().getOrigin().y());
    if (start.restore() != pd::Restored::yes) height = 0;
  }
  world.removeRigidBody(&cube);
  world.removeRigidBody(&floor);
  return height;
}
