#include "shapes/body_motion.hpp"

#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>

namespace pd::detail {

namespace {

/// A link's velocities at its centre of mass, in its own frame.
struct LinkVelocity {
  btVector3 turn;
  btVector3 velocity;
};

/// Walks from the base to the link, since Bullet keeps the velocities of joints only.
LinkVelocity velocity_of(const btMultiBody& body, int index) {
  if (index < 0) {
    const btQuaternion& from_world = body.getWorldToBaseRot();
    return {quatRotate(from_world, body.getBaseOmega()), quatRotate(from_world, body.getBaseVel())};
  }
  const btMultibodyLink& link = body.getLink(index);
  const LinkVelocity parent = velocity_of(body, link.m_parent);
  const btMatrix3x3 from_parent(link.m_cachedRotParentToThis);
  LinkVelocity own;
  own.turn = from_parent * parent.turn;
  own.velocity = from_parent * parent.velocity + own.turn.cross(link.m_cachedRVector);
  const btScalar* const joint = body.getJointVelMultiDof(index);
  for (int dof = 0; dof < link.m_dofCount; ++dof) {
    own.turn += joint[dof] * link.getAxisTop(dof);
    own.velocity += joint[dof] * link.getAxisBottom(dof);
  }
  return own;
}

void motion_of_link(const btMultiBodyLinkCollider& collider, btScalar seconds, BodyMotion& out) {
  const btMultiBody& body = *collider.m_multiBody;
  const int index = collider.m_link;
  const btTransform& pose = collider.getWorldTransform();
  const LinkVelocity own = velocity_of(body, index);
  out.link = true;
  out.turn = pose.getBasis() * own.turn;
  out.velocity = pose.getBasis() * own.velocity;
  out.centre = pose.getOrigin();
  const btScalar mass = index < 0 ? body.getBaseMass() : body.getLinkMass(index);
  const bool held = body.hasFixedBase() && body.getNumDofs() == 0;
  if (!held && mass > 0) out.gained = (index < 0 ? body.getBaseForce() : body.getLinkForce(index)) * (seconds / mass);
}

}  // namespace

bool motion_of(const btCollisionObject& object, btScalar seconds, BodyMotion& out) {
  if (const btRigidBody* const body = btRigidBody::upcast(&object)) {
    out.velocity = body->getLinearVelocity();
    out.gained = body->getTotalForce() * (body->getInvMass() * seconds);
    out.turn = body->getAngularVelocity();
    out.centre = body->getCenterOfMassPosition();
    return true;
  }
  if (const btMultiBodyLinkCollider* const link = btMultiBodyLinkCollider::upcast(&object)) {
    if (link->m_multiBody == nullptr) return false;
    motion_of_link(*link, seconds, out);
    return true;
  }
  return object.isStaticObject();
}

}  // namespace pd::detail
