#include "pair/step_reach.hpp"

#include <BulletCollision/CollisionShapes/btBoxShape.h>

#include <algorithm>
#include <typeinfo>

#include "pd/bullet/scalar.hpp"

namespace pd::detail {

namespace {

/// Of the threshold.
constexpr btScalar kNear = btScalar(0.25), kNearOfPieces = btScalar(0.5);
constexpr btScalar kClosing = 2;

}  // namespace

StepReach::StepReach(const btManifoldResult& result, btScalar threshold, btScalar seconds)
    : threshold_(threshold), seconds_(seconds) {
  const btCollisionObject& a = *result.getBody0Internal();
  const btCollisionObject& b = *result.getBody1Internal();
  all_ = !(seconds > 0) || result.m_closestPointDistanceThreshold > 0 || typeid(result) != typeid(btManifoldResult) ||
         !a.hasContactResponse() || !b.hasContactResponse() || !motion_of(a, seconds, a_) || !motion_of(b, seconds, b_);
}

bool StepReach::motion_of(const btCollisionObject& object, btScalar seconds, Motion& out) {
  const btRigidBody* const body = btRigidBody::upcast(&object);
  if (body == nullptr) return object.isStaticObject();
  out.velocity = body->getLinearVelocity() + body->getTotalForce() * (body->getInvMass() * seconds);
  out.turn = body->getAngularVelocity();
  out.centre = body->getCenterOfMassPosition();
  return true;
}

btScalar StepReach::of_boxes(const btConvexShape& a, const btConvexShape& b) const {
  if (all_) return threshold_;
  const auto turning = [](const Motion& motion, const btConvexShape& shape) {
    const btVector3 half = static_cast<const btBoxShape&>(shape).getHalfExtentsWithMargin();
    return btSqrt(motion.turn.length2() * half.length2());
  };
  const btScalar speed = (a_.velocity - b_.velocity).length() + turning(a_, a) + turning(b_, b);
  return std::min(threshold_, kNear * threshold_ + kClosing * seconds_ * speed);
}

btScalar StepReach::of_pieces_near(const btVector3& place, btScalar radius) const {
  if (all_) return threshold_;
  const btScalar speed = coming_at(place).length() + (a_.turn - b_.turn).length() * radius;
  return std::min(threshold_, kNearOfPieces * threshold_ + kClosing * seconds_ * speed);
}

btVector3 StepReach::coming_at(const btVector3& place) const {
  const btVector3 of_a = a_.velocity + a_.turn.cross(place - a_.centre);
  const btVector3 of_b = b_.velocity + b_.turn.cross(place - b_.centre);
  return of_b - of_a;
}

bool StepReach::is_needed(btScalar distance, const btVector3& place, const btVector3& normal, btScalar near) const {
  if (distance <= near) return true;
  const btScalar closing = std::max(btScalar(0), coming_at(place).dot(normal));
  return distance <= near + kClosing * seconds_ * closing;
}

bool StepReach::may_be_idle(const FreshPoints& points, btScalar threshold) {
  for (int k = 0; k < points.count; ++k) {
    if (points.points[k].distance > kNear * threshold) return true;
  }
  return false;
}

void StepReach::leave_out_idle(FreshPoints& points) const {
  if (all_) return;
  int kept = 0;
  for (int k = 0; k < points.count; ++k) {
    const FreshPoint& point = points.points[k];
    if (is_needed(point.distance, point.point_on_b, point.normal, kNear * threshold_)) points.points[kept++] = point;
  }
  points.count = kept;
}

void StepReach::leave_out_idle(ContactManifold& points) const {
  if (all_) return;
  const btVector3 normal = to_bullet(points.normal);
  std::size_t kept = 0;
  for (std::size_t k = 0; k < static_cast<std::size_t>(points.count); ++k) {
    const ContactPoint& point = points.points[k];
    if (is_needed(static_cast<btScalar>(-point.depth), to_bullet(point.position_b), normal,
                  kNearOfPieces * threshold_)) {
      points.points[kept++] = point;
    }
  }
  points.count = static_cast<int>(kept);
}

}  // namespace pd::detail
