#include "pair/step_reach.hpp"

#include <BulletCollision/CollisionShapes/btBoxShape.h>

#include <algorithm>
#include <typeinfo>

#include "pd/bullet/scalar.hpp"

namespace pd::detail {

namespace {

/// Shares of the threshold.
constexpr btScalar kNear = btScalar(0.25), kNearOfPieces = btScalar(0.5);
constexpr btScalar kNearBeside = btScalar(1. / 64), kNearOfLinks = kNearBeside;
/// Forces press bodies together if this share of what they add leads one against the other.
constexpr btScalar kPressing = btScalar(0.25);
constexpr btScalar kClosing = 2;
/// Bodies that come no farther in a step than so many thresholds are held apart by one point that is near, if one of
/// them is stopped.
constexpr btScalar kHeld = 2;
/// Bodies that touch without a load are less deep in each other than this share of the breaking threshold.
constexpr btScalar kTouching = btScalar(1e-3);
/// Bodies slower than so many steps of gravity may just have been let go, and soon rest.
constexpr btScalar kFlying = 4;
/// Bodies fly together where their velocities differ by less than this share of their speed, which is rounding.
constexpr btScalar kTogether = btScalar(1e-3);
/// A body does not turn where its rim moves by less than this share of that difference.
constexpr btScalar kNotTurning = btScalar(1e-2);

}  // namespace

StepReach::StepReach(const btCollisionObject& a, const btCollisionObject& b, const btManifoldResult& result,
                     btScalar threshold, btScalar seconds)
    : threshold_(threshold), seconds_(seconds) {
  const bool unknown = !(seconds > 0) || result.m_closestPointDistanceThreshold > 0 ||
                       typeid(result) != typeid(btManifoldResult) || !a.hasContactResponse() ||
                       !b.hasContactResponse() || !motion_of(a, seconds, a_) || !motion_of(b, seconds, b_);
  const bool link = a_.link || b_.link;
  all_ = unknown || link;
  links_ = !unknown && link;
  fixed_ = a.isStaticOrKinematicObject() || b.isStaticOrKinematicObject();
  a_.velocity += a_.gained;
  b_.velocity += b_.gained;
}

btScalar StepReach::of_boxes(const btConvexShape& a, const btConvexShape& b) const {
  if (all_) return threshold_;
  const auto turning = [](const BodyMotion& motion, const btConvexShape& shape) {
    const btVector3 half = static_cast<const btBoxShape&>(shape).getHalfExtentsWithMargin();
    return btSqrt(motion.turn.length2() * half.length2());
  };
  const btScalar turn = turning(a_, a) + turning(b_, b);
  const btScalar together = (a_.velocity - b_.velocity).length() + turn;
  const btScalar alone = std::max(a_.velocity.length(), b_.velocity.length()) + turn;
  return std::min(threshold_, std::max(kNear * threshold_ + kClosing * seconds_ * together, seconds_ * alone));
}

btScalar StepReach::of_pieces_near(const btVector3& place, btScalar radius) const {
  if (all_) return threshold_;
  const btScalar speed = coming_at(place).length() + (a_.turn - b_.turn).length() * radius;
  return std::min(threshold_, kNearOfPieces * threshold_ + kClosing * seconds_ * speed);
}

btVector3 StepReach::coming_at(const btVector3& place) const { return b_.velocity_at(place) - a_.velocity_at(place); }

bool StepReach::is_needed(const FreshPoint& point, btScalar near, btScalar held) const {
  const auto closed = [&](btScalar speed) { return std::max(btScalar(0), seconds_ * speed); };
  return point.distance <= near ||
         point.distance <= near + kClosing * closed(coming_at(point.point_on_b).dot(point.normal)) ||
         std::max(point.distance, held) <= closed(closing_alone(point.point_on_b, point.normal));
}

btScalar StepReach::closing_alone(const btVector3& place, const btVector3& normal) const {
  const btScalar of_a = -a_.velocity_at(place).dot(normal), of_b = b_.velocity_at(place).dot(normal);
  return std::max({of_a + of_b, of_a, of_b});
}

bool StepReach::are_pressed(const btVector3& normal) const {
  const btScalar least = kPressing * std::max(a_.gained.length(), b_.gained.length());
  return std::max(-a_.gained.dot(normal), b_.gained.dot(normal)) > least;
}

bool StepReach::may_be_idle(const FreshPoints& points, btScalar threshold) {
  for (int k = 0; k < points.count; ++k) {
    if (points.points[k].distance > kNearBeside * threshold) return true;
  }
  return false;
}

void StepReach::leave_out_idle(FreshPoints& points) const {
  if (all_) return;
  const btScalar near = threshold_ * (are_pressed(points.points[0].normal) ? kNear : kNearBeside);
  const bool held = std::any_of(points.points.begin(), points.points.begin() + points.count,
                                [near](const FreshPoint& point) { return point.distance <= near; });
  const btScalar held_way = held ? kHeld * threshold_ : 0;
  keep_points(points, [&](const FreshPoint& point) { return is_needed(point, near, held_way); });
}

void StepReach::leave_out_idle(ContactManifold& points) const {
  if (all_) return;
  const btVector3 normal = to_bullet(points.normal);
  const auto end = std::remove_if(points.points.begin(), points.points.begin() + points.count, [&](const auto& point) {
    FreshPoint fresh;
    set_fresh_point(normal, point, fresh);
    return !is_needed(fresh, kNearOfPieces * threshold_, BT_LARGE_FLOAT);
  });
  points.count = static_cast<int>(end - points.points.begin());
}

std::array<int, 4> StepReach::leave_out_idle_of_links(FreshPoints& points) const {
  if (!links_) return {0, 1, 2, 3};
  return keep_points(points,
                     [this](const FreshPoint& point) { return is_needed(point, kNearOfLinks * threshold_, 0); });
}

btScalar StepReach::noise_of_speeds() const { return kTogether * std::min(a_.velocity.length(), b_.velocity.length()); }

bool StepReach::as_fast_as_each_other() const {
  const btScalar speed = std::min(a_.velocity.length(), b_.velocity.length());
  const btScalar least = kFlying * std::max(a_.gained.length(), b_.gained.length());
  return !all_ && speed > least && (a_.velocity - b_.velocity).length() <= noise_of_speeds();
}

bool StepReach::fly_together(btScalar radius) const {
  const btScalar turn = std::max(a_.turn.length(), b_.turn.length());
  return as_fast_as_each_other() && turn * radius <= kNotTurning * noise_of_speeds();
}

bool StepReach::may_be_stopped(const btVector3& normal) const {
  return closing_alone(a_.centre, normal) > noise_of_speeds();
}

void StepReach::leave_out_flying(FreshPoints& points) const {
  if (!as_fast_as_each_other()) return;
  const btScalar noise = noise_of_speeds();
  keep_points(points, [&](const FreshPoint& point) {
    const bool touching = point.distance > -kTouching * threshold_;
    return !touching || closing_alone(point.point_on_b, point.normal) > noise;
  });
}

}  // namespace pd::detail
