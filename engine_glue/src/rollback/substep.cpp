#include "rollback/substep.hpp"

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <algorithm>
#include <functional>
#include <utility>

#include "rollback/part_contacts.hpp"
#include "rollback/world_step.hpp"

namespace pd::detail {

namespace {

bool before(const btCollisionObject* a0, const btCollisionObject* b0, const btCollisionObject* a1,
            const btCollisionObject* b1) {
  const std::less<> less;
  return a0 != a1 ? less(a0, a1) : less(b0, b1);
}

btScalar total_impulse(const btPersistentManifold& manifold) {
  btScalar sum = 0;
  for (int k = 0; k < manifold.getNumContacts(); ++k) sum += manifold.getContactPoint(k).m_appliedImpulse;
  return sum;
}

}  // namespace

void set_forces(btRigidBody& body, const btVector3& force, const btVector3& torque) {
  const btVector3 linear_factor = body.getLinearFactor();
  const btVector3 angular_factor = body.getAngularFactor();
  body.clearForces();
  body.setLinearFactor(btVector3(1, 1, 1));
  body.setAngularFactor(btVector3(1, 1, 1));
  body.applyCentralForce(force);
  body.applyTorque(torque);
  body.setLinearFactor(linear_factor);
  body.setAngularFactor(angular_factor);
}

void SubStepper::begin_frame(btScalar frame) {
  frame_ = static_cast<double>(frame);
  last_cut_ = cut_;
  cut_ = false;
  sinking_ = {};
  forces_.clear();
  kinematics_.clear();
  driven_ = false;
  const auto& objects = world_.getCollisionObjectArray();
  for (int i = 0; i < objects.size(); ++i) {
    btRigidBody* body = btRigidBody::upcast(objects[i]);
    if (body == nullptr) continue;
    if (!body->isStaticOrKinematicObject()) {
      if (!body->getTotalForce().isZero() || !body->getTotalTorque().isZero()) {
        forces_.push_back({body, body->getTotalForce(), body->getTotalTorque()});
      }
    } else if (body->isKinematicObject() && body->isActive()) {
      Kinematic saved{body, body->getInterpolationWorldTransform(), body->getWorldTransform(), {}, {}};
      if (body->getMotionState() != nullptr) body->getMotionState()->getWorldTransform(saved.end);
      btTransformUtil::calculateVelocity(saved.start, saved.end, frame, saved.linear, saved.angular);
      kinematics_.push_back(saved);
      driven_ = driven_ || !saved.linear.isZero() || !saved.angular.isZero();
    }
  }
}

void SubStepper::keep_only(const std::vector<const btCollisionObject*>& present) {
  const auto gone = [&](const auto& noted) {
    return !std::binary_search(present.begin(), present.end(), static_cast<const btCollisionObject*>(noted.body),
                               std::less<>());
  };
  forces_.erase(std::remove_if(forces_.begin(), forces_.end(), gone), forces_.end());
  kinematics_.erase(std::remove_if(kinematics_.begin(), kinematics_.end(), gone), kinematics_.end());
}

void SubStepper::place_kinematics(double time) {
  for (const Kinematic& moved : kinematics_) {
    btRigidBody& body = *btRigidBody::upcast(moved.body);
    btTransform pose = moved.end;
    if (time < frame_) {
      btTransformUtil::integrateTransform(moved.start, moved.linear, moved.angular, static_cast<btScalar>(time), pose);
    }
    body.setWorldTransform(pose);
    body.setInterpolationWorldTransform(pose);
    body.setLinearVelocity(moved.linear);
    body.setAngularVelocity(moved.angular);
    body.setInterpolationLinearVelocity(moved.linear);
    body.setInterpolationAngularVelocity(moved.angular);
  }
}

void SubStepper::begin_part() {
  sunk_ = std::exchange(sinking_, {});
  energy_.begin_part();
  if (exact_flight_) flight_.begin_part();
}

void SubStepper::move(double from, double step, double gap, double slop) {
  flight_.note_start();
  move_bodies(from, step, gap, slop);
  if (exact_flight_) flight_.give_back_flags();
  energy_.restore();
}

bool SubStepper::must_repeat(double step) {
  const auto h = static_cast<btScalar>(step);
  return (exact_flight_ && flight_.misjudged(h)) || energy_.lessen(world_, h);
}

void SubStepper::finish_move(double step) {
  if (exact_flight_) flight_.finish(static_cast<btScalar>(step));
}

/// Gravity and the step, with what bodies that are to bounce keep for their flight left out.
void SubStepper::step_world(btScalar step) {
  world_.applyGravity();
  if (exact_flight_) flight_.take_forces();
  const HostActions::Aside aside(world_, actions_);
  // Contact algorithms leave impacts to Bullet's restitution here (StepTime, pair/bounce.hpp).
  btScalar& time_of_impact = world_.getDispatchInfo().m_timeOfImpact;
  const btScalar saved = time_of_impact;
  time_of_impact = 0;
  WorldStep::move(world_, step);
  time_of_impact = saved;
}

void SubStepper::move_bodies(double from, double step, double gap, double slop) {
  const auto h = static_cast<btScalar>(step);
  const bool whole = from == 0 && step >= frame_ && !driven_;
  const btScalar slow = whole ? BT_LARGE_FLOAT : static_cast<btScalar>(slop / step);
  // Pairs that come nearer by less than the slop in a whole step are not searched, and bounce off nothing.
  const btScalar gentle = whole ? static_cast<btScalar>(slop / step) : -BT_LARGE_FLOAT;
  const PartContacts contacts(
      world_.getDispatcher(),
      PartContacts::Rule{static_cast<btScalar>(kInContactGaps * gap), slow, gentle, sunk_.first, sunk_.second,
                         static_cast<btScalar>(kTouchingGaps * gap), static_cast<btScalar>(slop)},
      energy_);
  if (whole) {
    if (last_cut_) scale_warm_starts(step);
    WorldStep::save_kinematic_state(world_, h);
    step_world(h);
    return;
  }
  scale_warm_starts(step);
  btContactSolverInfo& info = world_.getSolverInfo();
  const btContactSolverInfo saved = info;
  const auto share = static_cast<btScalar>(step / frame_);
  info.m_erp *= share;
  info.m_erp2 *= share;
  info.m_frictionERP *= share;
  info.m_splitImpulse = true;
  if (sunk_.first != nullptr) info.m_splitImpulseTurnErp = 1;
  info.m_splitImpulsePenetrationThreshold = 0;
  info.m_linearSlop -= static_cast<btScalar>(kTouchingGaps * gap);
  // Contacts are found where bodies are when a part begins, so there kinematic bodies stand, too.
  place_kinematics(from);
  step_world(h);
  place_kinematics(from + step);
  const btScalar changed_by_bullet = info.m_timeStep;
  info = saved;
  info.m_timeStep = changed_by_bullet;
}

void SubStepper::accept(double from, double step) {
  const bool whole = from == 0 && step >= frame_;
  cut_ = cut_ || !whole;
  last_step_ = step;
  if (whole) note_pair_forces();
  world_.clearForces();
  for (const Forces& saved : forces_) set_forces(*saved.body, saved.force, saved.torque);
  actions_.call(world_, static_cast<btScalar>(step));
}

void SubStepper::end_frame() { world_.clearForces(); }

void SubStepper::scale_warm_starts(double step) {
  btDispatcher* dispatcher = world_.getDispatcher();
  // Only here are they looked up, so that frames that are not cut are spared the sorting.
  if (cut_ || last_cut_) {
    std::sort(pair_forces_.begin(), pair_forces_.end(),
              [](const PairForce& x, const PairForce& y) { return before(x.a, x.b, y.a, y.b); });
  }
  const btScalar scale = last_step_ > 0 ? static_cast<btScalar>(step / last_step_) : btScalar(1);
  for (int i = 0; i < dispatcher->getNumManifolds(); ++i) {
    btPersistentManifold& manifold = *dispatcher->getManifoldByIndexInternal(i);
    const btScalar sum = total_impulse(manifold);
    if (!(sum > 0)) continue;
    btScalar factor = scale;
    if (cut_ || last_cut_) factor = std::min(factor, pair_force(manifold) * static_cast<btScalar>(step) / sum);
    for (int k = 0; k < manifold.getNumContacts(); ++k) {
      btManifoldPoint& point = manifold.getContactPoint(k);
      point.m_appliedImpulse *= factor;
      point.m_appliedImpulseLateral1 *= factor;
      point.m_appliedImpulseLateral2 *= factor;
    }
  }
}

void SubStepper::note_pair_forces() {
  pair_forces_.clear();
  btDispatcher* dispatcher = world_.getDispatcher();
  for (int i = 0; i < dispatcher->getNumManifolds(); ++i) {
    const btPersistentManifold& manifold = *dispatcher->getManifoldByIndexInternal(i);
    const btScalar sum = total_impulse(manifold);
    if (sum > 0) {
      pair_forces_.push_back({manifold.getBody0(), manifold.getBody1(), sum / static_cast<btScalar>(frame_)});
    }
  }
}

btScalar SubStepper::pair_force(const btPersistentManifold& manifold) const {
  const PairForce wanted{manifold.getBody0(), manifold.getBody1(), 0};
  const auto found =
      std::lower_bound(pair_forces_.begin(), pair_forces_.end(), wanted,
                       [](const PairForce& x, const PairForce& y) { return before(x.a, x.b, y.a, y.b); });
  // A compound has a manifold for each pair of children; the strongest speaks for the pair.
  btScalar force = 0;
  for (auto it = found; it != pair_forces_.end() && it->a == wanted.a && it->b == wanted.b; ++it) {
    force = std::max(force, it->force);
  }
  return force;
}

}  // namespace pd::detail
