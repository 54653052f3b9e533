#include "rollback/part_contacts.hpp"

#include <BulletCollision/BroadphaseCollision/btCollisionAlgorithm.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <algorithm>

#include "pair/dispatcher_owners.hpp"

namespace pd::detail {

namespace {

using Owners = DispatcherOwners<PartContacts>;

/// How fast the bodies of a contact approach each other at a point of it, before the step.
btScalar approach(const btPersistentManifold& manifold, const btManifoldPoint& point) {
  const auto velocity = [&](const btCollisionObject& object, const btVector3& at) {
    const btRigidBody* body = btRigidBody::upcast(&object);
    return body != nullptr ? body->getVelocityInLocalPoint(at - body->getWorldTransform().getOrigin())
                           : btVector3(0, 0, 0);
  };
  return point.m_normalWorldOnB.dot(velocity(*manifold.getBody1(), point.getPositionWorldOnB()) -
                                    velocity(*manifold.getBody0(), point.getPositionWorldOnA()));
}

bool bounces(const btBroadphaseProxy* proxy) {
  return static_cast<const btCollisionObject*>(proxy->m_clientObject)->getRestitution() > 0;
}

}  // namespace

PartContacts::PartContacts(btDispatcher* dispatcher, const Rule& rule, ImpactEnergy& energy)
    : dispatcher_(dynamic_cast<btCollisionDispatcher*>(dispatcher)), rule_(rule), energy_(energy) {
  if (dispatcher_ == nullptr) return;
  host_ = dispatcher_->getNearCallback();
  Owners::instance().add(dispatcher_, this);
  dispatcher_->setNearCallback(&PartContacts::near);
}

PartContacts::~PartContacts() {
  if (dispatcher_ == nullptr) return;
  dispatcher_->setNearCallback(host_);
  Owners::instance().remove(dispatcher_);
  for (const KeptErp& kept : kept_) {
    kept.point->m_contactERP = kept.value;
    kept.point->m_contactPointFlags &= ~BT_CONTACT_FLAG_HAS_CONTACT_ERP;
  }
}

void PartContacts::near(btBroadphasePair& pair, btCollisionDispatcher& dispatcher, const btDispatcherInfo& info) {
  PartContacts* const self = Owners::instance().find(dispatcher);
  self->host_(pair, dispatcher, info);
  if (pair.m_algorithm == nullptr) return;
  const bool bouncing = bounces(pair.m_pProxy0) && bounces(pair.m_pProxy1);
  if (!bouncing && self->rule_.slow == BT_LARGE_FLOAT) return;
  thread_local btManifoldArray manifolds;  // asked for every pair of every step: its memory is kept
  manifolds.resize(0);
  pair.m_algorithm->getAllContactManifolds(manifolds);
  for (int i = 0; i < manifolds.size(); ++i) {
    btPersistentManifold& manifold = *manifolds[i];
    if (bouncing) {
      self->drop_of_bouncing(manifold);
      if (self->energy_.any()) self->energy_.apply(manifold);
    } else {
      self->drop_of_fast(manifold);
    }
    self->put_back(manifold);
  }
}

void PartContacts::drop_of_bouncing(btPersistentManifold& manifold) const {
  for (int k = manifold.getNumContacts() - 1; k >= 0; --k) {
    const btManifoldPoint& point = manifold.getContactPoint(k);
    if (!(point.m_combinedRestitution > 0 && point.getDistance() > rule_.farthest)) continue;
    if (approach(manifold, point) > rule_.gentle) manifold.removeContactPoint(k);
  }
}

void PartContacts::drop_of_fast(btPersistentManifold& manifold) const {
  for (int k = 0; k < manifold.getNumContacts(); ++k) {
    if (manifold.getContactPoint(k).getDistance() <= rule_.farthest) return;
  }
  for (int k = manifold.getNumContacts() - 1; k >= 0; --k) {
    if (approach(manifold, manifold.getContactPoint(k)) > rule_.slow) manifold.removeContactPoint(k);
  }
}

void PartContacts::put_back(btPersistentManifold& manifold) {
  const auto is = [&](const btCollisionObject* a, const btCollisionObject* b) {
    return a == rule_.sunk_a && b == rule_.sunk_b;
  };
  if (rule_.sunk_a == nullptr) return;
  if (!is(manifold.getBody0(), manifold.getBody1()) && !is(manifold.getBody1(), manifold.getBody0())) return;
  // Who has set a point's own stiffness keeps it.
  constexpr int kOwn = BT_CONTACT_FLAG_HAS_CONTACT_ERP | BT_CONTACT_FLAG_CONTACT_STIFFNESS_DAMPING;
  for (int k = 0; k < manifold.getNumContacts(); ++k) {
    btManifoldPoint& point = manifold.getContactPoint(k);
    const btScalar depth = rule_.touching - point.getDistance();
    if (!(depth > 0) || (point.m_contactPointFlags & kOwn) != 0) continue;
    const std::lock_guard lock(keeping_);
    kept_.push_back({&point, point.m_contactERP});
    point.m_contactERP = std::min(btScalar(1), rule_.slop / depth);
    point.m_contactPointFlags |= BT_CONTACT_FLAG_HAS_CONTACT_ERP;
  }
}

}  // namespace pd::detail
