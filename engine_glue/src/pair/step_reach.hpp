/// @file
/// Which points of a pair the solver can need in this step.
///
/// A point that is apart limits how fast it may close, to its gap in one step: where it closes more slowly, the solver
/// visits it in every sweep and does nothing. Half of the points of a house of cards are such. Left out is what is
/// apart by more than a quarter of the breaking threshold and twice what the bodies' velocities and forces close until
/// the next step; the quarter and the two are for what other contacts may do meanwhile. A box that moves may
/// be stopped by another one: a column that falls as one lands box by box, so that each box's own speed counts as well,
/// once. It does not count where another point of the pair is near and the boxes are slow: that point holds the pair.
/// Boxes side by side, which no force presses together, as the bricks of a course of a wall, have a sixty-fourth in
/// place of the quarter: a fifth of a wall's points would be theirs. Of parts of compounds it is half the threshold:
/// they are linked, and a chain that tautens moves faster than it did. A row of a multibody costs ten times a row of a
/// rigid body. So of links it is a sixty-fourth, whatever their shapes: a point that a motor's blow brings nearer than
/// that in one step is handed out in the next one. Points of other rigid bodies are all handed out, since looking for
/// idle ones costs as much as they do.
///
/// Boxes that fly together, as a block that falls, touch without a load. Their points are needed where one of them may
/// be stopped, that is, where its own speed leads against the other.
#pragma once

#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include <array>

#include "pair/manifold_points.hpp"
#include "shapes/body_motion.hpp"

namespace pd::detail {

class StepReach {
 public:
  /// All points are needed where a host reads them without a step (contact tests, bodies without response, a distance
  /// asked for beyond the threshold) or a velocity is not known (links of multibodies).
  /// @param threshold  at which contacts break, and what the query asks for beyond it
  StepReach(const btManifoldResult& result, btScalar threshold, btScalar seconds)
      : StepReach(*result.getBody0Internal(), *result.getBody1Internal(), result, threshold, seconds) {}
  /// @param a, b  whose order the points' normals follow, where it is not the result's
  StepReach(const btCollisionObject& a, const btCollisionObject& b, const btManifoldResult& result, btScalar threshold,
            btScalar seconds);

  /// True if points can be left out, and one of the bodies is static or kinematic.
  [[nodiscard]] bool against_fixed() const { return !all_ && fixed_; }
  /// The way by which the bodies close along a normal (unit, from B to A) at a place until the next step. Requires that
  /// their motion is known.
  [[nodiscard]] btScalar closed_in_step(const btVector3& place, const btVector3& normal) const {
    return seconds_ * coming_at(place).dot(normal);
  }

  /// How far apart points may be to be needed. Requires two btBoxShapes.
  [[nodiscard]] btScalar of_boxes(const btConvexShape& a, const btConvexShape& b) const;
  /// The same of two pieces' points, which lie within `radius` of a place.
  [[nodiscard]] btScalar of_pieces_near(const btVector3& place, btScalar radius) const;

  /// Whether any of a pair's points may not be needed: mostly all touch, and nothing else has to be known.
  [[nodiscard]] static bool may_be_idle(const FreshPoints& points, btScalar threshold);
  /// Takes those that are not needed out.
  void leave_out_idle(FreshPoints& points) const;
  /// The same of two pieces'.
  void leave_out_idle(ContactManifold& points) const;
  /// Takes out the points that a link of a multibody does not need. Does nothing for rigid bodies.
  /// @return for each point that is left, the number that it had before.
  std::array<int, 4> leave_out_idle_of_links(FreshPoints& points) const;
  /// True if both bodies fly, as fast as each other. False where points must not be left out.
  [[nodiscard]] bool as_fast_as_each_other() const;
  /// True if both bodies fly, as fast as each other, and neither turns but by rounding. False where points must not be
  /// left out.
  /// @param radius  of the larger body, about its centre
  [[nodiscard]] bool fly_together(btScalar radius) const;
  /// True if the own speed of one of two bodies that fly together leads against the other along a normal (unit, from B
  /// to A): a third body that stops the other one would press them together.
  [[nodiscard]] bool may_be_stopped(const btVector3& normal) const;
  /// Takes out the points of two boxes that fly together which are not needed. Requires that the pair carried nothing
  /// in the last step.
  void leave_out_flying(FreshPoints& points) const;

 private:
  /// How B's material at a place comes to A's.
  [[nodiscard]] btVector3 coming_at(const btVector3& place) const;
  /// @param near  up to which gap all are
  /// @param held  the way in a step up to which another point keeps the bodies apart if one of them is stopped
  [[nodiscard]] bool is_needed(const FreshPoint& point, btScalar near, btScalar held) const;
  /// Below this, a difference of two bodies' speeds is rounding.
  [[nodiscard]] btScalar noise_of_speeds() const;
  /// True if the forces on one of the bodies lead it against the other along a normal (unit, from B to A).
  [[nodiscard]] bool are_pressed(const btVector3& normal) const;
  /// How fast two bodies may come together at a place, if another contact stops one of them.
  [[nodiscard]] btScalar closing_alone(const btVector3& place, const btVector3& normal) const;

  btScalar threshold_;
  btScalar seconds_;
  bool all_;
  bool links_;
  bool fixed_;
  BodyMotion a_, b_;  ///< with what the step's forces add
};

}  // namespace pd::detail
