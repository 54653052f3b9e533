#include "rollback/multibody_state.hpp"

#include <BulletDynamics/Featherstone/btMultiBodyConstraint.h>

#include <algorithm>

namespace pd::detail {

void MultiBodyState::save(btDiscreteDynamicsWorld& world) {
  bodies_.clear();
  impulses_.clear();
  auto* articulated = dynamic_cast<btMultiBodyDynamicsWorld*>(&world);
  if (articulated == nullptr) return;
  for (int i = 0; i < articulated->getNumMultibodies(); ++i) {
    btMultiBody* body = articulated->getMultiBody(i);
    Body saved{body,
               body->getBasePos(),
               body->getWorldToBaseRot(),
               body->getBaseForce(),
               body->getBaseTorque(),
               body->isAwake(),
               {},
               {}};
    const btScalar* velocities = body->getVelocityVector();
    saved.velocities.assign(velocities, velocities + 6 + body->getNumDofs());
    for (int k = 0; k < body->getNumLinks(); ++k) {
      Link link{};
      std::copy_n(body->getJointPosMultiDof(k), 7, link.position);
      std::copy_n(body->getJointTorqueMultiDof(k), 6, link.torque);
      link.force = body->getLinkForce(k);
      link.moment = body->getLinkTorque(k);
      saved.links.push_back(link);
    }
    bodies_.push_back(std::move(saved));
  }
  for (int i = 0; i < articulated->getNumMultiBodyConstraints(); ++i) {
    btMultiBodyConstraint* constraint = articulated->getMultiBodyConstraint(i);
    for (int row = 0; row < constraint->getNumRows(); ++row) {
      impulses_.push_back({constraint, row, constraint->getAppliedImpulse(row)});
    }
  }
}

bool MultiBodyState::same(btDiscreteDynamicsWorld& world) const {
  auto* articulated = dynamic_cast<btMultiBodyDynamicsWorld*>(&world);
  if (articulated == nullptr) return bodies_.empty() && impulses_.empty();
  if (static_cast<std::size_t>(articulated->getNumMultibodies()) != bodies_.size()) return false;
  for (int i = 0; i < articulated->getNumMultibodies(); ++i) {
    const Body& saved = bodies_[static_cast<std::size_t>(i)];
    const btMultiBody* const present = articulated->getMultiBody(i);
    if (present != saved.body || static_cast<std::size_t>(present->getNumLinks()) != saved.links.size() ||
        static_cast<std::size_t>(6 + present->getNumDofs()) != saved.velocities.size()) {
      return false;
    }
  }
  std::size_t place = 0;
  for (int i = 0; i < articulated->getNumMultiBodyConstraints(); ++i) {
    const btMultiBodyConstraint* const present = articulated->getMultiBodyConstraint(i);
    for (int row = 0; row < present->getNumRows(); ++row, ++place) {
      if (place >= impulses_.size() || impulses_[place].constraint != present) return false;
    }
  }
  return place == impulses_.size();
}

void MultiBodyState::restore() const {
  btAlignedObjectArray<btQuaternion> rotations;
  btAlignedObjectArray<btVector3> origins;
  for (const Body& saved : bodies_) {
    btMultiBody& body = *saved.body;
    if (saved.awake != body.isAwake()) {
      if (saved.awake) {
        body.wakeUp();
      } else {
        body.goToSleep();
      }
    }
    body.setBasePos(saved.position);
    body.setWorldToBaseRot(saved.rotation);
    // The one way to write velocities that knows nothing of joint types: the vector that Bullet itself integrates.
    std::copy(saved.velocities.begin(), saved.velocities.end(), const_cast<btScalar*>(body.getVelocityVector()));
    body.clearForcesAndTorques();
    body.addBaseForce(saved.force);
    body.addBaseTorque(saved.torque);
    for (int k = 0; k < body.getNumLinks(); ++k) {
      const Link& link = saved.links[static_cast<std::size_t>(k)];
      body.setJointPosMultiDof(k, link.position);
      body.addLinkForce(k, link.force);
      body.addLinkTorque(k, link.moment);
      std::copy_n(link.torque, 6, body.getJointTorqueMultiDof(k));
    }
    body.forwardKinematics(rotations, origins);
    body.updateCollisionObjectWorldTransforms(rotations, origins);
  }
  for (const Impulse& saved : impulses_) saved.constraint->internalSetAppliedImpulse(saved.row, saved.impulse);
}

}  // namespace pd::detail
