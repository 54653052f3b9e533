#include "pair/bounce.hpp"

#include <BulletCollision/BroadphaseCollision/btDispatcher.h>

#include <algorithm>
#include <typeinfo>

#include "pair/manifold_points.hpp"

namespace pd::detail {

namespace {

/// What keeps less than a hundredth of the height is stopped at the surface like a body without restitution. To bounce
/// so little, it would first have to go in by up to a step's way.
constexpr btScalar kLeastRestitution = btScalar(0.1);
/// The default of `btContactSolverInfo::m_restitutionVelocityThreshold`, in metres a second: what comes together more
/// slowly does not bounce.
constexpr btScalar kLeastBounce = btScalar(0.2);
/// Of the way that the bodies came in one step: deeper than that they were in each other before.
constexpr btScalar kOneStep = btScalar(1 + 1. / 64);
/// Bullet's error reduction mends a fifth of the depth in a step. What separates faster than that needs none.
constexpr btScalar kStepsOut = 5;

}  // namespace

StepTime time_of(const btDispatcherInfo& info) { return {info.m_timeStep, !(info.m_timeOfImpact > 0)}; }

Bounce::Bounce(const btPersistentManifold& manifold, const btManifoldResult& result, const StepTime& time)
    : seconds_(time.seconds) {
  if (time.at_impact) return;
  const btCollisionObject& a = *manifold.getBody0();
  const btCollisionObject& b = *manifold.getBody1();
  const int flags = a.getCollisionFlags() | b.getCollisionFlags();
  told_ = gContactAddedCallback != nullptr && (flags & btCollisionObject::CF_CUSTOM_MATERIAL_CALLBACK) != 0;
  restitution_ = gCalculateCombinedRestitutionCallback(&a, &b);
  if (!told_ && !(restitution_ >= kLeastRestitution)) return;
  // A spring between the bodies, which the host asked for, has its own law.
  if ((flags & btCollisionObject::CF_HAS_CONTACT_STIFFNESS_DAMPING) != 0) return;
  if (!(seconds_ > 0) || result.m_closestPointDistanceThreshold > 0 || typeid(result) != typeid(btManifoldResult)) {
    return;
  }
  possible_ =
      a.hasContactResponse() && b.hasContactResponse() && motion_of(a, seconds_, a_) && motion_of(b, seconds_, b_);
}

Bounce::Approach Bounce::approach_of(btScalar distance, const btVector3& normal, const btVector3& place_a,
                                     const btVector3& place_b, btScalar restitution) const {
  const btScalar dt = seconds_;
  Approach out{Phase::slow, normal.dot(b_.velocity_at(place_b) - a_.velocity_at(place_a)),
               normal.dot(b_.gained - a_.gained), 0};
  const btScalar closing = out.closing, gained = out.gained;
  if (closing < -kLeastBounce) {
    out.phase = Phase::leaving;
    return out;
  }
  // Also where a speed is NaN.
  if (!(closing > kLeastBounce) || -distance > kOneStep * dt * closing) return out;
  if (distance > (closing + gained) * dt) {
    out.phase = Phase::coming;
    return out;
  }
  const btScalar falls_on = distance * gained / dt;
  const btScalar energy = std::max(btScalar(0), btScalar(0.5) * closing * (closing + gained) + falls_on);
  const btScalar square = btScalar(0.25) * gained * gained + 2 * (restitution * restitution * energy - falls_on);
  out.after = btSqrt(std::max(btScalar(0), square)) - btScalar(0.5) * gained;
  // It would not even bounce up to where it is: it touches first.
  out.phase = distance > 0 && out.after <= 0 ? Phase::coming : Phase::bouncing;
  return out;
}

void Bounce::leave_out(FreshPoints& points) const {
  if (!(restitution_ >= kLeastRestitution)) return;
  keep_points(points, [this](const FreshPoint& point) {
    const btVector3 place_a = point.point_on_b + point.normal * point.distance;
    const Phase phase = approach_of(point.distance, point.normal, place_a, point.point_on_b, restitution_).phase;
    return phase != Phase::coming && (phase != Phase::leaving || !(point.distance > 0));
  });
}

void Bounce::set(btManifoldPoint& point, ImpulseTrend& impulse) const {
  const btScalar restitution = told_ ? point.m_combinedRestitution : restitution_;
  if (!(restitution >= kLeastRestitution)) return;
  const btScalar distance = point.getDistance();
  const Approach approach = approach_of(distance, point.m_normalWorldOnB, point.getPositionWorldOnA(),
                                        point.getPositionWorldOnB(), restitution);
  const auto leave_depth = [&] {
    point.m_contactERP = 0;
    point.m_contactPointFlags |= BT_CONTACT_FLAG_HAS_CONTACT_ERP;
  };
  switch (approach.phase) {
    case Phase::slow:
      return;
    case Phase::coming:
      point.m_combinedRestitution = 0;
      return;
    case Phase::leaving:
      point.m_appliedImpulse = 0;
      impulse = ImpulseTrend();
      if (-distance < kStepsOut * seconds_ * -approach.closing) leave_depth();
      return;
    case Phase::bouncing:
      break;
  }
  leave_depth();
  // The solver of multibodies takes the speed after the step's forces, that of rigid bodies the speed before.
  const btScalar speed = a_.link || b_.link ? approach.closing + approach.gained : approach.closing;
  if (!(speed > 0)) return;
  point.m_combinedRestitution = (approach.after + std::max(btScalar(0), distance) / seconds_) / speed;
}

}  // namespace pd::detail
