/// @file
/// Two boxes that fly together, as those of a block that falls, keep the points of the step in which they were last
/// asked.
///
/// While their poses differ from those of the question by the rounding of poses alone, the answer's facet stays the
/// nearest one up to that rounding. The points move along with B, and their distances change by the part of the
/// rounding along the normal. A block that falls would ask each of its pairs in each step otherwise, although nothing
/// has happened between them.
#pragma once

#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <BulletCollision/CollisionShapes/btConvexShape.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

#include <array>

namespace pd::detail {

class StepReach;

/// Two boxes in the order of their question, and the reach of contacts in it.
struct BoxesInFlight {
  const btConvexShape& a;
  const btTransform& pose_a;
  const btConvexShape& b;
  const btTransform& pose_b;
  btScalar threshold;
};

class FlightMemory {
 public:
  [[nodiscard]] bool known() const { return known_; }
  void forget() { known_ = false; }

  /// Remembers the points that the manifold holds since this step's question, if the boxes fly together.
  /// @param normal  from B to A, of all points of the answer, those that were left out included
  void begin(const BoxesInFlight& boxes, const btVector3& normal, const StepReach& reach,
             const btPersistentManifold& manifold);

  /// Requires `known`. True if the boxes stand to each other as they did in the question, and the manifold holds as
  /// many points as it did after it.
  [[nodiscard]] bool same_place(const BoxesInFlight& boxes, const btPersistentManifold& manifold) const;
  /// Requires `known`. True if the boxes fly together, and the same points are needed as in the question.
  [[nodiscard]] bool same_flight(const StepReach& reach) const;
  /// Moves the manifold's points to where B is. Requires `same_place`.
  void move_points(const BoxesInFlight& boxes, btPersistentManifold& manifold) const;

 private:
  [[nodiscard]] btScalar radius() const;  ///< of the larger box
  struct Point {
    btVector3 from_b;  ///< on B, from B's centre
    btScalar distance;
  };

  bool known_ = false;
  bool may_be_stopped_ = false;  ///< so that points are needed that carry nothing
  btScalar threshold_ = 0;
  btMatrix3x3 basis_a_, basis_b_;
  btVector3 half_a_, half_b_;
  btVector3 way_;  ///< from A's centre to B's
  btVector3 normal_;
  int num_points_ = 0;
  std::array<Point, 4> points_;
};

}  // namespace pd::detail
