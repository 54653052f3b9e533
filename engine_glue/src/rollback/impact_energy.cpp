#include "rollback/impact_energy.hpp"

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <algorithm>
#include <cmath>

namespace pd::detail {

namespace {

/// Of the energy that goes into an impact (the sum of |p . v-|): what an impact may seem to gain by rounding and by
/// sweeps that have not converged.
constexpr double kAllowed = 1e-4;
/// Friction that changes from slip to stick moves the zero of W; the last try is without restitution.
constexpr int kMostRepeats = 5;

const btRigidBody* rigid(const btCollisionObject* object) { return btRigidBody::upcast(object); }

}  // namespace

void ImpactEnergy::begin_part() {
  pairs_.clear();
  repeated_ = 0;
}

btVector3 ImpactEnergy::velocity_before(const btRigidBody& body, const btVector3& point, btScalar step) const {
  const FreeFlight::Start& start = flight_.start_of(body);
  const btVector3 arm = point - start.pose.getOrigin();
  if (body.isStaticOrKinematicObject()) return body.getLinearVelocity() + body.getAngularVelocity().cross(arm);
  // As Bullet: damping, then the forces of the step.
  const btVector3 linear = start.linear * btPow(1 - body.getLinearDamping(), step) +
                           step * body.getInvMass() * body.getLinearFactor() * body.getTotalForce();
  const btVector3 angular = start.angular * btPow(1 - body.getAngularDamping(), step) +
                            step * (body.getInvInertiaTensorWorld() * body.getTotalTorque());
  return linear + angular.cross(arm);
}

btVector3 ImpactEnergy::velocity_after(const btRigidBody& body, const btVector3& point) const {
  const FreeFlight::Start& start = flight_.start_of(body);
  return body.getLinearVelocity() + body.getAngularVelocity().cross(point - start.pose.getOrigin());
}

btScalar ImpactEnergy::share_of(const btPersistentManifold& manifold) const {
  for (const PairWork& pair : pairs_) {
    if (pair.a == manifold.getBody0() && pair.b == manifold.getBody1()) return pair.share;
  }
  return 1;
}

ImpactEnergy::PairWork& ImpactEnergy::work_of(const btPersistentManifold& manifold) {
  // All manifolds of a pair of compounds, which need not follow each other.
  for (PairWork& work : works_) {
    if (work.a == manifold.getBody0() && work.b == manifold.getBody1()) return work;
  }
  works_.push_back({manifold.getBody0(), manifold.getBody1(), share_of(manifold), 0, 0, 0});
  return works_.back();
}

void ImpactEnergy::add(const btPersistentManifold& manifold, const btContactSolverInfo& info, btScalar step) {
  const btRigidBody* a = rigid(manifold.getBody0());
  const btRigidBody* b = rigid(manifold.getBody1());
  if (a == nullptr || b == nullptr || !(a->getRestitution() > 0) || !(b->getRestitution() > 0)) return;
  const bool two_directions = (info.m_solverMode & SOLVER_USE_2_FRICTION_DIRECTIONS) != 0;
  for (int k = 0; k < manifold.getNumContacts(); ++k) {
    const btManifoldPoint& point = manifold.getContactPoint(k);
    if (!(point.m_appliedImpulse > 0)) continue;
    btVector3 impulse =
        point.m_appliedImpulse * point.m_normalWorldOnB + point.m_appliedImpulseLateral1 * point.m_lateralFrictionDir1;
    if (two_directions) impulse += point.m_appliedImpulseLateral2 * point.m_lateralFrictionDir2;
    const btVector3& on_a = point.getPositionWorldOnA();
    const btVector3& on_b = point.getPositionWorldOnB();
    const btVector3 before = velocity_before(*a, on_a, step) - velocity_before(*b, on_b, step);
    const btVector3 after = velocity_after(*a, on_a) - velocity_after(*b, on_b);
    PairWork& work = work_of(manifold);
    work.given += static_cast<double>(impulse.dot(before));
    work.work += 0.5 * static_cast<double>(impulse.dot(before + after));
    if (-before.dot(point.m_normalWorldOnB) > info.m_restitutionVelocityThreshold) {
      work.e = std::max(work.e, static_cast<double>(point.m_combinedRestitution));
    }
  }
}

bool ImpactEnergy::lessen(btDiscreteDynamicsWorld& world, btScalar step) {
  if (repeated_ >= kMostRepeats) return false;
  works_.clear();
  btDispatcher* dispatcher = world.getDispatcher();
  for (int i = 0; i < dispatcher->getNumManifolds(); ++i) {
    add(*dispatcher->getManifoldByIndexInternal(i), world.getSolverInfo(), step);
  }
  double total = 0;
  double given = 0;
  for (const PairWork& work : works_) {
    total += work.work;
    given += std::abs(work.given);
  }
  if (!(total > kAllowed * given)) return false;
  ++repeated_;
  bool changed = false;
  for (PairWork& work : works_) {
    if (!(work.work > 0) || !(work.e > 0) || !(work.share > 0)) continue;
    const double e = work.e * static_cast<double>(work.share);
    const double next = -work.given * (1 + e) / (work.work - work.given) - 1;
    const bool last = repeated_ == kMostRepeats || !(next > 0 && next < e);
    work.share = last ? btScalar(0) : static_cast<btScalar>(next / work.e);
    const auto known = std::find_if(pairs_.begin(), pairs_.end(),
                                    [&](const PairWork& pair) { return pair.a == work.a && pair.b == work.b; });
    if (known == pairs_.end()) {
      pairs_.push_back(work);
    } else {
      known->share = work.share;
    }
    changed = true;
  }
  return changed;
}

void ImpactEnergy::apply(btPersistentManifold& manifold) {
  const btScalar share = share_of(manifold);
  if (share == 1) return;
  const std::lock_guard lock(keeping_);
  for (int k = 0; k < manifold.getNumContacts(); ++k) {
    btManifoldPoint& point = manifold.getContactPoint(k);
    kept_.push_back({&point, point.m_combinedRestitution});
    point.m_combinedRestitution *= share;
  }
}

void ImpactEnergy::restore() {
  for (const KeptRestitution& kept : kept_) kept.point->m_combinedRestitution = kept.value;
  kept_.clear();
}

}  // namespace pd::detail
