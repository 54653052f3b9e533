#include "rollback/host_actions.hpp"

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include "rollback/world_step.hpp"

namespace pd::detail {

namespace {

/// As btDiscreteDynamicsWorld::updateActivationState for one body.
void decide_sleep(btRigidBody& body, btScalar step) {
  body.updateDeactivation(step);
  if (!body.wantsSleeping()) {
    if (body.getActivationState() != DISABLE_DEACTIVATION) body.setActivationState(ACTIVE_TAG);
    return;
  }
  if (body.isStaticOrKinematicObject()) {
    body.setActivationState(ISLAND_SLEEPING);
    return;
  }
  if (body.getActivationState() == ACTIVE_TAG) body.setActivationState(WANTS_DEACTIVATION);
  if (body.getActivationState() == ISLAND_SLEEPING) {
    body.setAngularVelocity(btVector3(0, 0, 0));
    body.setLinearVelocity(btVector3(0, 0, 0));
  }
}

}  // namespace

HostActions::Aside::Aside(btDiscreteDynamicsWorld& world, HostActions& actions) : present_(WorldStep::actions(world)) {
  actions.undecided_.clear();
  if (present_.size() == 0) return;
  saved_.copyFromArray(present_);
  present_.resize(0);
  present_.push_back(&actions);
}

HostActions::Aside::~Aside() {
  if (saved_.size() > 0) present_.copyFromArray(saved_);
}

void HostActions::updateAction(btCollisionWorld* world, btScalar /*step*/) {
  const auto& bodies = static_cast<btDiscreteDynamicsWorld*>(world)->getNonStaticRigidBodies();
  for (int i = 0; i < bodies.size(); ++i) {
    btRigidBody* body = bodies[i];
    undecided_.push_back({body, body->getActivationState(), body->getDeactivationTime(), body->getLinearVelocity(),
                          body->getAngularVelocity()});
  }
}

void HostActions::call(btDiscreteDynamicsWorld& world, btScalar step) {
  if (WorldStep::actions(world).size() == 0) return;
  for (const Rest& rest : undecided_) {
    rest.body->forceActivationState(rest.activation_state);
    rest.body->setDeactivationTime(rest.deactivation_time);
    // Bullet stops those that sleep; the others may have their velocity from a flight that followed.
    if (rest.activation_state == ISLAND_SLEEPING) {
      rest.body->setLinearVelocity(rest.linear);
      rest.body->setAngularVelocity(rest.angular);
    }
  }
  WorldStep::call_actions(world, step);
  const auto& bodies = world.getNonStaticRigidBodies();
  for (int i = 0; i < bodies.size(); ++i) decide_sleep(*bodies[i], step);
}

}  // namespace pd::detail
