#include "rollback/free_flight.hpp"

#include <BulletDynamics/ConstraintSolver/btTypedConstraint.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "pd/bullet/scalar.hpp"
#include "rollback/free_rotation.hpp"

namespace pd::detail {

namespace {

/// Bullet's default. Who asks for one of its other two terms, or for none, keeps it.
constexpr int kGyroscopic = BT_ENABLE_GYROSCOPIC_FORCE_IMPLICIT_BODY;
/// Bullet turns no body farther than this in a step (ANGULAR_MOTION_THRESHOLD of btTransformUtil.h); neither does a
/// flight, which then turns it as far as it goes in the first part of the step.
constexpr double kMostTurn = 0.25 * static_cast<double>(SIMD_PI);

bool is_pushed(const btPersistentManifold& manifold) {
  for (int k = 0; k < manifold.getNumContacts(); ++k) {
    if (manifold.getContactPoint(k).m_appliedImpulse > 0) return true;
  }
  return false;
}

btRigidBody* dynamic_body(const btCollisionObject* object) {
  btRigidBody* body = btRigidBody::upcast(const_cast<btCollisionObject*>(object));
  return body != nullptr && !body->isStaticOrKinematicObject() ? body : nullptr;
}

/// Whether the body turns by Euler's equations (as the host wants it to), and not at a constant angular velocity.
bool turns_freely(const btRigidBody& body, int flags) {
  const btVector3& inverse = body.getInvInertiaDiagLocal();
  return (flags & kGyroscopic) != 0 && body.getTotalTorque().isZero() &&
         body.getAngularFactor() == btVector3(1, 1, 1) && inverse.x() > 0 && inverse.y() > 0 && inverse.z() > 0 &&
         !(inverse.x() == inverse.y() && inverse.y() == inverse.z());
}

Rotation turned_freely(const btTransform& pose, const btVector3& angular, const btRigidBody& body, double time) {
  const btQuaternion q = pose.getRotation();
  const Vec3 inverse = to_pd(body.getInvInertiaDiagLocal());
  const Vec3 omega = to_pd(angular);
  const double way = omega.norm() * time;
  // By way of the quaternion, since a basis in Bullet's scalar is a rotation up to its rounding only, which would grow.
  const Eigen::Quaterniond orientation(static_cast<double>(q.w()), static_cast<double>(q.x()),
                                       static_cast<double>(q.y()), static_cast<double>(q.z()));
  return rotate_freely({orientation.normalized().toRotationMatrix(), omega}, inverse.cwiseInverse(),
                       way > kMostTurn ? time * (kMostTurn / way) : time);
}

/// What Bullet's step makes of an angular velocity that was damped already, if nothing touches the body. Leaves the
/// body at that pose and velocity.
btVector3 bullets_turning(btRigidBody& body, const btTransform& pose, const btVector3& damped, btScalar step) {
  body.setWorldTransform(pose);
  body.setAngularVelocity(damped);
  return damped + body.computeGyroscopicImpulseImplicit_Body(step);
}

btMatrix3x3 to_basis(const Mat3& rotation) {
  btMatrix3x3 basis;
  for (int i = 0; i < 3; ++i) basis[i] = to_bullet(Vec3(rotation.row(i).transpose()));
  return basis;
}

}  // namespace

void FreeFlight::expect_impact(const btCollisionObject* a, const btCollisionObject* b) { expected_ = {a, b}; }

void FreeFlight::begin_part() {
  bounces_.clear();
  // Bodies without restitution do not leave what they meet.
  const auto bounces = [](const btCollisionObject* object) { return object->getRestitution() > 0; };
  const btCollisionObjectArray& objects = world_.getCollisionObjectArray();
  // The last part may have ended with its frame, and the host may have taken a body away since.
  const auto is_here = [&](const btCollisionObject* object) {
    return objects.findLinearSearch(const_cast<btCollisionObject*>(object)) != objects.size();
  };
  if (!std::all_of(expected_.begin(), expected_.end(), [&](auto* one) { return is_here(one) && bounces(one); })) {
    expected_.clear();
  }
  if (expected_.empty()) return;
  const auto other_than_expected = [&](const btCollisionObject* object) {
    return std::find(expected_.begin(), expected_.end(), object) == expected_.end();
  };
  for (const btCollisionObject* object : expected_) {
    btRigidBody* body = dynamic_body(object);
    if (body == nullptr || body->getInternalType() != btCollisionObject::CO_RIGID_BODY) continue;
    bool held = !body->getTotalTorque().isZero();
    btDispatcher* dispatcher = world_.getDispatcher();
    for (int i = 0; i < dispatcher->getNumManifolds() && !held; ++i) {
      const btPersistentManifold& manifold = *dispatcher->getManifoldByIndexInternal(i);
      const btCollisionObject* b0 = manifold.getBody0();
      const btCollisionObject* b1 = manifold.getBody1();
      if (b0 != body && b1 != body) continue;
      held = other_than_expected(b0 == body ? b1 : b0) && is_pushed(manifold);
    }
    for (int i = 0; i < world_.getNumConstraints() && !held; ++i) {
      const btTypedConstraint* joint = world_.getConstraint(i);
      held = joint->isEnabled() && (&joint->getRigidBodyA() == body || &joint->getRigidBodyB() == body);
    }
    if (!held) bounces_.push_back({body, body->getFlags(), btVector3(0, 0, 0)});
  }
  expected_.clear();
}

void FreeFlight::note_start() {
  const auto& objects = world_.getCollisionObjectArray();
  starts_.resize(static_cast<std::size_t>(objects.size()));
  for (int i = 0; i < objects.size(); ++i) {
    Start& start = starts_[static_cast<std::size_t>(i)];
    start.flew = false;
    if (const btRigidBody* body = btRigidBody::upcast(objects[i])) {
      start.pose = body->getWorldTransform();
      start.linear = body->getLinearVelocity();
      start.angular = body->getAngularVelocity();
    }
  }
}

void FreeFlight::take_forces() {
  for (Bounce& bounce : bounces_) {
    bounce.force = bounce.body->getTotalForce();
    bounce.body->clearForces();
    bounce.body->setFlags(bounce.flags & ~kGyroscopic);
  }
}

void FreeFlight::give_back_flags() {
  for (const Bounce& bounce : bounces_) bounce.body->setFlags(bounce.flags);
}

const FreeFlight::Bounce* FreeFlight::bounce_of(const btCollisionObject* object) const {
  for (const Bounce& bounce : bounces_) {
    if (bounce.body == object) return &bounce;
  }
  return nullptr;
}

bool FreeFlight::leaves(const btPersistentManifold& manifold, btScalar step) const {
  const btRigidBody* a = btRigidBody::upcast(manifold.getBody0());
  const btRigidBody* b = btRigidBody::upcast(manifold.getBody1());
  if (a == nullptr || b == nullptr) return false;
  const auto moves = [&](const btRigidBody& body, const btVector3& point, btVector3& velocity, btVector3& way) {
    velocity = body.getVelocityInLocalPoint(point - start_of(body).pose.getOrigin());
    way = step * velocity;
    if (const Bounce* bounce = bounce_of(&body)) way += btScalar(0.5) * step * step * body.getInvMass() * bounce->force;
  };
  for (int k = 0; k < manifold.getNumContacts(); ++k) {
    const btManifoldPoint& point = manifold.getContactPoint(k);
    if (!(point.m_appliedImpulse > 0)) continue;
    btVector3 velocity_a, way_a, velocity_b, way_b;
    moves(*a, point.getPositionWorldOnA(), velocity_a, way_a);
    moves(*b, point.getPositionWorldOnB(), velocity_b, way_b);
    if (!(point.m_normalWorldOnB.dot(velocity_a - velocity_b) > 0 && point.m_normalWorldOnB.dot(way_a - way_b) > 0)) {
      return false;
    }
  }
  return true;
}

bool FreeFlight::misjudged(btScalar step) {
  if (bounces_.empty()) return false;
  std::vector<const btCollisionObject*> staying;
  btDispatcher* dispatcher = world_.getDispatcher();
  for (int i = 0; i < dispatcher->getNumManifolds(); ++i) {
    const btPersistentManifold& manifold = *dispatcher->getManifoldByIndexInternal(i);
    const bool one = bounce_of(manifold.getBody0()) != nullptr || bounce_of(manifold.getBody1()) != nullptr;
    if (!one || !is_pushed(manifold) || leaves(manifold, step)) continue;
    staying.push_back(manifold.getBody0());
    staying.push_back(manifold.getBody1());
  }
  const auto stays = [&](const Bounce& bounce) {
    return std::find(staying.begin(), staying.end(), bounce.body) != staying.end();
  };
  const auto kept = std::remove_if(bounces_.begin(), bounces_.end(), stays);
  const bool changed = kept != bounces_.end();
  bounces_.erase(kept, bounces_.end());
  return changed;
}

void FreeFlight::mark_touched() {
  for (Start& start : starts_) start.touched = false;
  btDispatcher* dispatcher = world_.getDispatcher();
  for (int i = 0; i < dispatcher->getNumManifolds(); ++i) {
    const btPersistentManifold& manifold = *dispatcher->getManifoldByIndexInternal(i);
    if (!is_pushed(manifold)) continue;
    start_of(*manifold.getBody0()).touched = true;
    start_of(*manifold.getBody1()).touched = true;
  }
  for (int i = 0; i < world_.getNumConstraints(); ++i) {
    const btTypedConstraint* joint = world_.getConstraint(i);
    if (!joint->isEnabled()) continue;
    for (const btRigidBody* body : {&joint->getRigidBodyA(), &joint->getRigidBodyB()}) {
      if (body->getWorldArrayIndex() >= 0) start_of(*body).touched = true;
    }
  }
}

void FreeFlight::fly(btRigidBody& body, Start& start, const Bounce* bounce, btScalar step) {
  const int flags = bounce != nullptr ? bounce->flags : body.getFlags();
  start.flew = true;
  start.acceleration = body.getInvMass() * (bounce != nullptr ? bounce->force : body.getTotalForce());
  start.turned = turns_freely(body, flags);
  const bool falls = !start.acceleration.isZero();
  if (bounce != nullptr) {
    start.linear = body.getLinearVelocity();
    start.angular = body.getAngularVelocity();
  }
  if (!falls && !start.turned) return;
  btTransform pose = body.getWorldTransform();
  if (falls) {
    const btVector3 half = btScalar(0.5) * step * step * start.acceleration;
    // Bullet's own way was a h^2 where it knew of the force, and 0 where it did not.
    pose.setOrigin(bounce != nullptr ? pose.getOrigin() + half : pose.getOrigin() - half);
    if (bounce != nullptr) body.setLinearVelocity(body.getLinearVelocity() + step * start.acceleration);
  }
  if (start.turned) {
    btVector3 angular = start.angular;  // after an impact: what it left
    btVector3 by_others(0, 0, 0);       // soft bodies, or a host's own step, may have turned it since
    if (bounce == nullptr) {
      angular *= btPow(1 - body.getAngularDamping(), step);
      by_others = body.getAngularVelocity();
      by_others -= bullets_turning(body, start.pose, angular, step);
    }
    const Rotation turned = turned_freely(start.pose, angular, body, static_cast<double>(step));
    pose.setBasis(to_basis(turned.orientation));
    body.setAngularVelocity(to_bullet(turned.angular_velocity) + by_others);
  }
  body.setCenterOfMassTransform(pose);
}

void FreeFlight::finish(btScalar step) {
  mark_touched();
  const auto& objects = world_.getCollisionObjectArray();
  for (int i = 0; i < objects.size(); ++i) {
    btRigidBody* body = dynamic_body(objects[i]);
    // Bullet's own clamp of fast motion leaves a hit fraction of 0.
    if (body == nullptr || !body->isActive() || body->getHitFraction() < 1) continue;
    Start& start = starts_[static_cast<std::size_t>(i)];
    const Bounce* bounce = bounce_of(body);
    if (bounce != nullptr || !start.touched) fly(*body, start, bounce, step);
  }
}

bool FreeFlight::predict(const btCollisionObject& object, double time, btTransform& pose) const {
  const btRigidBody* body = dynamic_body(&object);
  if (body == nullptr) return false;
  const Start& start = start_of(object);
  if (!start.flew) return false;
  const auto t = static_cast<btScalar>(time);
  btTransformUtil::integrateTransform(start.pose, start.linear, start.angular, t, pose);
  pose.setOrigin(pose.getOrigin() + btScalar(0.5) * t * t * start.acceleration);
  if (start.turned) {
    pose.setBasis(to_basis(turned_freely(start.pose, start.angular, *body, time).orientation));
  }
  return true;
}

}  // namespace pd::detail
