#include "pair/flight_memory.hpp"

#include <BulletCollision/CollisionShapes/btBoxShape.h>

#include <algorithm>
#include <limits>

#include "pair/step_reach.hpp"

namespace pd::detail {

namespace {

/// Roundings of a coordinate. A position that grows by the same way in each step is rounded in each of them.
constexpr btScalar kRoundings = 4 * std::numeric_limits<btScalar>::epsilon();

btVector3 half_extents(const btConvexShape& box) {
  return static_cast<const btBoxShape&>(box).getHalfExtentsWithMargin();
}

/// Entries of a rotation are at most 1.
bool nearly_equal(const btMatrix3x3& a, const btMatrix3x3& b) {
  for (int i = 0; i < 3; ++i) {
    const btVector3 difference = (a[i] - b[i]).absolute();
    if (!(difference[difference.maxAxis()] <= kRoundings)) return false;
  }
  return true;
}

}  // namespace

void FlightMemory::begin(const BoxesInFlight& boxes, const btVector3& normal, const StepReach& reach,
                         const btPersistentManifold& manifold) {
  half_a_ = half_extents(boxes.a);
  half_b_ = half_extents(boxes.b);
  known_ = reach.fly_together(radius());
  if (!known_) return;
  may_be_stopped_ = reach.may_be_stopped(normal);
  threshold_ = boxes.threshold;
  basis_a_ = boxes.pose_a.getBasis();
  basis_b_ = boxes.pose_b.getBasis();
  way_ = boxes.pose_b.getOrigin() - boxes.pose_a.getOrigin();
  normal_ = normal;
  num_points_ = manifold.getNumContacts();
  for (int i = 0; i < num_points_; ++i) {
    const btManifoldPoint& point = manifold.getContactPoint(i);
    points_[static_cast<std::size_t>(i)] = {point.m_positionWorldOnB - boxes.pose_b.getOrigin(), point.m_distance1};
  }
}

bool FlightMemory::same_place(const BoxesInFlight& boxes, const btPersistentManifold& manifold) const {
  if (manifold.getNumContacts() != num_points_) return false;
  const btVector3 &at_a = boxes.pose_a.getOrigin(), &at_b = boxes.pose_b.getOrigin();
  const btVector3 moved = (at_b - at_a) - way_;
  for (int k = 0; k < 3; ++k) {
    const btScalar size = std::max(btFabs(at_a[k]), btFabs(at_b[k]));
    if (!(btFabs(moved[k]) <= kRoundings * size)) return false;
  }
  return threshold_ == boxes.threshold && nearly_equal(basis_a_, boxes.pose_a.getBasis()) &&
         nearly_equal(basis_b_, boxes.pose_b.getBasis()) && half_a_ == half_extents(boxes.a) &&
         half_b_ == half_extents(boxes.b);
}

btScalar FlightMemory::radius() const { return btSqrt(std::max(half_a_.length2(), half_b_.length2())); }

bool FlightMemory::same_flight(const StepReach& reach) const {
  return reach.fly_together(radius()) && reach.may_be_stopped(normal_) == may_be_stopped_;
}

void FlightMemory::move_points(const BoxesInFlight& boxes, btPersistentManifold& manifold) const {
  const btVector3& at_b = boxes.pose_b.getOrigin();
  const btScalar closer = normal_.dot((at_b - boxes.pose_a.getOrigin()) - way_);
  for (int i = 0; i < num_points_; ++i) {
    const Point& known = points_[static_cast<std::size_t>(i)];
    btManifoldPoint& point = manifold.getContactPoint(i);
    point.m_distance1 = known.distance - closer;
    point.m_positionWorldOnB = at_b + known.from_b;
    point.m_positionWorldOnA = point.m_positionWorldOnB + normal_ * point.m_distance1;
    ++point.m_lifeTime;
  }
}

}  // namespace pd::detail
