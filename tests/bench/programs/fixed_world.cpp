/// @file
/// Parts of a world whose instructions callgrind counts (`instruction_budget.cmake`): bricks that lie half on others,
/// as in a pyramid, after a second of steps. `fixed_world brick` counts the whole of `processCollision` of one pair:
/// bounding boxes, query, manifold, and points with their impulses and anchors. `step` counts a step of the world, and
/// `step_recorder_gone` one after a `pd::ContactRecorder` has come and gone: no instruction more.

#include <btBulletDynamicsCommon.h>

#include <cstdio>
#include <memory>
#include <string_view>
#include <vector>

#include "pd/bullet/contact_recorder.hpp"
#include "pd/bullet/install.hpp"
#include "pd/bullet/penetration_depth_solver.hpp"

extern "C" {

/// By its plain name in callgrind's option --toggle-collect.
__attribute__((noinline)) void pdepth_counted_call(btCollisionAlgorithm* algorithm, const btCollisionObjectWrapper* a,
                                                   const btCollisionObjectWrapper* b, const btDispatcherInfo* info,
                                                   btManifoldResult* result, btDynamicsWorld* world) {
  if (world != nullptr) {
    world->stepSimulation(btScalar(1) / 60, 0);
  } else {
    algorithm->processCollision(a, b, *info, result);
  }
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

  /// Records nothing for long. False where it could not.
  bool record_and_stop() {
    pd::ContactRecorder recorder(world_, "/dev/null");
    return recorder.close();
  }

  void counted_step() { pdepth_counted_call(nullptr, nullptr, nullptr, nullptr, nullptr, &world_); }

  /// The pair of the upper brick and the first lower one. @return the points that it has.
  int visit() {
    btBroadphasePair* const pair =
        world_.getPairCache()->findPair(bodies_[1]->getBroadphaseHandle(), bodies_[3]->getBroadphaseHandle());
    auto* const a = static_cast<btCollisionObject*>(pair->m_pProxy0->m_clientObject);
    auto* const b = static_cast<btCollisionObject*>(pair->m_pProxy1->m_clientObject);
    const btCollisionObjectWrapper wrapper_a(nullptr, a->getCollisionShape(), a, a->getWorldTransform(), -1, -1);
    const btCollisionObjectWrapper wrapper_b(nullptr, b->getCollisionShape(), b, b->getWorldTransform(), -1, -1);
    btManifoldResult result(&wrapper_a, &wrapper_b);
    pdepth_counted_call(pair->m_algorithm, &wrapper_a, &wrapper_b, &world_.getDispatchInfo(), &result, nullptr);
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
  const std::string_view name = argc == 2 ? argv[1] : "";
  Bricks bricks;
  bricks.step(60);
  if (name == "brick") {
    const int points = bricks.visit();
    std::printf("brick: %d points\n", points);
    return points == 4 ? 0 : 1;
  }
  if (name == "step" || name == "step_recorder_gone") {
    if (name == "step_recorder_gone" && !bricks.record_and_stop()) return 1;
    bricks.counted_step();
    return 0;
  }
  std::fprintf(stderr, "fixed_world NAME, one of: brick, step, step_recorder_gone\n");
  return 2;
}
