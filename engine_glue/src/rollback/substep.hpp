/// @file
/// A part of a frame's step, made so that cutting the frame adds no energy.
///
/// Bullet's corrections are per step: the bias velocity is erp * depth / h, the warm start is an impulse of the last h,
/// a gap g forbids to approach faster than g / h. A part h of a frame H that took them as they are would throw out
/// whatever is deep, H / h times too fast. So within a part
///   - erp, erp2 and friction's erp are scaled by h / H: the bias velocity is that of the whole frame;
///   - depth is mended by split impulses, which move bodies and leave their velocities alone;
///   - pairs nearer than twice the gap count as touching (`m_linearSlop`), so that an impact at a gap of 1e-5 keeps its
///     restitution whatever h is;
///   - pairs that bounce and are farther apart than that do not brake each other: Bullet would let them come as near as
///     their gap in this part, and take the speed that is left over without giving it back (in a whole frame those do
///     that come nearer by less than the slop, which are not searched). Neither do others that have
///     no nearer point and approach by more than the slop in the part: they meet when the search says so, where braked
///     ones would come to the end of every part as near as that, and no nearer;
///   - warm starts are scaled to h, and never above the force that the pair carried before the frame was cut: an
///     impact's impulse is no force to start the next part with;
///   - the pair in contact that ended the last part by sinking is put back, by at most the slop;
///   - impacts whose restitution would add energy have less of it (`impact_energy.hpp`);
///   - bodies that nothing touches fly as such bodies do, after an impact, too (`free_flight.hpp`), in frames that are
///     not cut as well.
#pragma once

#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>

#include <utility>
#include <vector>

#include "rollback/free_flight.hpp"
#include "rollback/host_actions.hpp"
#include "rollback/impact_energy.hpp"

namespace pd::detail {

/// Pairs nearer than so many gaps touch, for Bullet, and others that it brakes come as near as that.
inline constexpr double kTouchingGaps = 2;
/// Pairs nearer than so many gaps are in contact, for the search: braked ones, wherever rounding left them, among them.
inline constexpr double kInContactGaps = 2.25;

class SubStepper {
 public:
  /// @param exact_flight  as `RollbackSettings::exact_flight`
  SubStepper(btDiscreteDynamicsWorld& world, bool exact_flight)
      : world_(world), exact_flight_(exact_flight), flight_(world), energy_(flight_) {}

  /// Notes the forces that the host has applied and where kinematic bodies are and are to be.
  void begin_frame(btScalar frame);
  /// Forgets what was noted of objects that are none of these, which are sorted by address: the host has taken them out
  /// of the world since the frame began.
  void keep_only(const std::vector<const btCollisionObject*>& present);
  /// A part begins, of which all moves are trials.
  void begin_part();
  /// Moves from `from` to `from + step` seconds of the frame: Bullet's own step where that is all of it, no kinematic
  /// body moves and the last frame was not cut.
  void move(double from, double step, double gap, double slop);
  /// Whether the last move is to be made again from where it began, for what it showed of the part's impacts: they
  /// added energy by their restitution, of which they have less from here on, or bodies did not bounce that were
  /// expected to.
  bool must_repeat(double step);
  /// After a move that is not made again: bodies in flight go where their forces take them.
  void finish_move(double step);
  /// Where a body in flight would be after `time` of the last move. @return false for all others.
  bool predict(const btCollisionObject& body, double time, btTransform& pose) const {
    return exact_flight_ && flight_.predict(body, time, pose);
  }
  /// The part that was accepted last ended just before these met.
  void expect_impact(const btCollisionObject* a, const btCollisionObject* b) { flight_.expect_impact(a, b); }
  /// The part that was accepted last ended because these, in contact, went deeper than they may: the next part puts
  /// them back by the slop.
  void expect_deep(const btCollisionObject* a, const btCollisionObject* b) { sinking_ = {a, b}; }
  /// The state that the last move left is kept: its impulses are of a step of that length, forces begin anew, and the
  /// host's actions are called.
  void accept(double from, double step);
  /// After the frame's last part.
  void end_frame();

 private:
  struct Forces {
    btRigidBody* body;
    btVector3 force;
    btVector3 torque;
  };
  struct Kinematic {
    btCollisionObject* body;
    btTransform start;
    btTransform end;
    btVector3 linear;
    btVector3 angular;
  };
  struct PairForce {
    const btCollisionObject* a;
    const btCollisionObject* b;
    btScalar force;
  };

  void move_bodies(double from, double step, double gap, double slop);
  void step_world(btScalar step);
  void scale_warm_starts(double step);
  void note_pair_forces();
  [[nodiscard]] btScalar pair_force(const btPersistentManifold& manifold) const;
  void place_kinematics(double time);

  btDiscreteDynamicsWorld& world_;
  bool exact_flight_;
  double frame_ = 0;
  double last_step_ = 0;   ///< that of the impulses that contact points carry; 0: none known
  bool cut_ = false;       ///< this frame has been accepted in parts
  bool last_cut_ = false;  ///< the last one was
  bool driven_ = false;    ///< a kinematic body moves in this frame
  std::vector<Forces> forces_;
  std::vector<Kinematic> kinematics_;
  std::vector<PairForce> pair_forces_;                                     ///< of the last frame that was not cut
  std::pair<const btCollisionObject*, const btCollisionObject*> sinking_;  ///< that the next part puts back
  std::pair<const btCollisionObject*, const btCollisionObject*> sunk_;     ///< that this one does
  FreeFlight flight_;
  ImpactEnergy energy_;
  HostActions actions_;
};

/// Bullet has no setter for the accumulated force, only additions that it multiplies by the body's factors.
void set_forces(btRigidBody& body, const btVector3& force, const btVector3& torque);

}  // namespace pd::detail
