/// @file
/// One visit to a pair of a world whose instructions callgrind counts (`instruction_budget.cmake`): a brick that lies
/// half on another one, as in a pyramid, after a second of steps. `fixed_world brick` counts the whole of
/// `processCollision`: bounding boxes, query, manifold, and points with their impulses and anchors.

#include <btBulletDynamicsCommon.h>

#include <cstdio>
#include <cstring>
#include <memory>
#include <vector>

#include "pd/bullet/install.hpp"
#include "pd/bullet/penetration_depth_solver.hpp"

extern "C" {

/// By its plain name in callgrind's option --toggle-collect.
__attribute__((noinline)) void pdepth_counted_call(btCollisionAlgorithm* algorithm, const btCollisionObjectWrapper* a,
                                                   const btCollisionObjectWrapper* b, const btDispatcherInfo* info,
                                                   btManifoldResult* result) {
  algorithm->processCollision(a, b, *info, result);
}
}

namespace {

class Bricks {
 public:
  Bricks() : dispatcher_(&configuration_), world_(&dispatcher_, &broadphase_, &constraints_, &configuration_) {
    pd::install(dispatcher_, solver_);
    world_.setGravity(btVector3(0, btScalar(-9.81), 0));
    add(&ground_, 0, btVector3(0, -1, 0));
    for (const btScalar x : {btScalar(-0.5), btScalar(0.5)}) add(&brick_, 1, btVector3(x, btScalar(0.25), 0));
    add(&brick_, 1, btVector3(0, btScalar(0.75), 0));
  }
  ~Bricks() {
    for (const auto& body : bodies_) world_.removeRigidBody(body.get());
  }

  void step(int steps) {
    for (int i = 0; i < steps; ++i) world_.stepSimulation(btScalar(1) / 60, 0);
  }

  /// The pair of the upper brick and the first lower one. @return the points that it has.
  int visit() {
    btBroadphasePair* const pair =
        world_.getPairCache()->findPair(bodies_[1]->getBroadphaseHandle(), bodies_[3]->getBroadphaseHandle());
    auto* const a = static_cast<btCollisionObject*>(pair->m_pProxy0->m_clientObject);
    auto* const b = static_cast<btCollisionObject*>(pair->m_pProxy1->m_clientObject);
    const btCollisionObjectWrapper wrapper_a(nullptr, a->getCollisionShape(), a, a->getWorldTransform(), -1, -1);
    const btCollisionObjectWrapper wrapper_b(nullptr, b->getCollisionShape(), b, b->getWorldTransform(), -1, -1);
    btManifoldResult result(&wrapper_a, &wrapper_b);
    pdepth_counted_call(pair->m_algorithm, &wrapper_a, &wrapper_b, &world_.getDispatchInfo(), &result);
    return result.getPersistentManifold()->getNumContacts();
  }

 private:
  void add(btCollisionShape* shape, btScalar mass, const btVector3& at) {
    btVector3 inertia(0, 0, 0);
    if (mass > 0) shape->calculateLocalInertia(mass, inertia);
    bodies_.push_back(std::make_unique<btRigidBody>(mass, nullptr, shape, inertia));
    bodies_.back()->setWorldTransform(btTransform(btQuaternion::getIdentity(), at));
    bodies_.back()->setActivationState(DISABLE_DEACTIVATION);
    world_.addRigidBody(bodies_.back().get());
  }

  btBoxShape ground_{btVector3(20, 1, 20)};
  btBoxShape brick_{btVector3(btScalar(0.5), btScalar(0.25), btScalar(0.25))};
  pd::BulletPenetrationDepthSolver solver_;
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_;
  btDbvtBroadphase broadphase_;
  btSequentialImpulseConstraintSolver constraints_;
  btDiscreteDynamicsWorld world_;
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2 || std::strcmp(argv[1], "brick") != 0) {
    std::fprintf(stderr, "fixed_world NAME, one of: brick\n");
    return 2;
  }
  Bricks bricks;
  bricks.step(60);
  const int points = bricks.visit();
  std::printf("brick: %d points\n", points);
  return points == 4 ? 0 : 1;
}
