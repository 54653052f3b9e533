/// @file
/// Contact points of pairs with restitution, so that a bounce keeps the share e^2 of the height at every rate.
///
/// Bullet's solver turns a point into the demand that the bodies separate with at least
///
///     e * c - gap / dt   (apart),      e * c + depth * error reduction / dt   (in each other),
///
/// where c is the speed at which they come together. So a point that is handed out before the bodies touch takes the
/// speed away that the next step would give back, and a point that is handed out late adds speed that nobody had: at
/// 240 Hz Bullet's boxes bounce to 1.2 of their height. Beside that, both the way that is left and the step's own share
/// of gravity are lost or gained with the phase of the step, which at 30 Hz is a tenth of the height.
///
/// Here a point that comes faster than Bullet's restitution threshold (its default: an algorithm does not know its
/// world) is handed out in the step that it touches in, and not before, and its restitution is set so that the energy
/// of the motion in steps is what it should be. With the acceleration a towards each other, x the gap and u the speed
/// of separation, Bullet's way to integrate keeps u^2 / 2 + a x - a dt u / 2 from step to step; the bounce multiplies
/// it by e^2. A point that separates that fast is not handed out once it is apart, carries no impulse on, and is not
/// pushed where it leaves by itself.
#pragma once

#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

#include "pair/impulse_trend.hpp"
#include "shapes/body_motion.hpp"

struct btDispatcherInfo;

namespace pd::detail {

struct FreshPoints;

/// The length of a step. A `RollbackStepper` ends its parts where bodies meet, and Bullet's own restitution is exact
/// there: it sets `btDispatcherInfo::m_timeOfImpact`, which a discrete world leaves at 1, to 0.
struct StepTime {
  btScalar seconds;
  bool at_impact = false;

  // NOLINTNEXTLINE(google-explicit-constructor): most readers ask for the length alone.
  operator btScalar() const { return seconds; }
};
[[nodiscard]] StepTime time_of(const btDispatcherInfo& info);

class Bounce {
 public:
  /// @param manifold  whose bodies' order the points' normals follow
  Bounce(const btPersistentManifold& manifold, const btManifoldResult& result, const StepTime& time);

  /// False: neither body bounces, and nothing is to be done.
  [[nodiscard]] bool possible() const { return possible_; }
  /// Takes out the points that do not touch in this step, or that separate.
  void leave_out(FreshPoints& points) const;
  /// Sets what the solver makes of a point that has been put into the manifold.
  void set(btManifoldPoint& point, ImpulseTrend& impulse) const;

 private:
  enum class Phase {
    slow,      ///< as any other point
    coming,    ///< touches after this step
    bouncing,  ///< touches in this step, or has done so in the last one
    leaving,
  };
  struct Approach {
    Phase phase;
    btScalar closing;  ///< the speed at which the bodies come together, before the step's forces
    btScalar gained;   ///< by the step's forces
    btScalar after;    ///< of `bouncing`: the speed at which they are to separate
  };
  [[nodiscard]] Approach approach_of(btScalar distance, const btVector3& normal, const btVector3& place_a,
                                     const btVector3& place_b, btScalar restitution) const;

  btScalar seconds_;  ///< of the step
  bool possible_ = false;
  bool told_ = false;         ///< the host's callback may set a point's own restitution
  btScalar restitution_ = 0;  ///< of the bodies
  BodyMotion a_, b_;
};

}  // namespace pd::detail
