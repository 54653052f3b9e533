#include "contact/separation_along.hpp"

#include <algorithm>

#include "depth/difference/smooth_difference.hpp"
#include "numeric/length.hpp"
#include "numeric/turn.hpp"
#include "numeric/unit_roundoff.hpp"
#include "shape/core_radius.hpp"
#include "shape/support/polytope_support.hpp"

namespace pd::detail {

namespace {

/// A few roundings on the way to a radius or a curvature.
constexpr double kRoundedUp = 1 + 32 * kUnitRoundoff;

}  // namespace

MovingSupport::MovingSupport(const MovingShape& body)
    : body_(body),
      rotation_(body.start.shape->polytope() ? body.start.pose.rotation() : body.start.pose.nearest_rotation()),
      pivot_(body.start.pose.translation() - body.arm),
      speed_(length(body.motion.angular_velocity)) {
  if (speed_ > 0) axis_ = body.motion.angular_velocity / speed_;
  double from_axis = 0;
  if (const ConvexPolytope* polytope = body.start.shape->polytope()) {
    for (int v = 0; v < polytope->num_vertices(); ++v) {
      const Vec3 r = body.arm + rotation_ * polytope->vertex(v);
      radius_ = std::max(radius_, length(r));
      from_axis = std::max(from_axis, length(Vec3(axis_.cross(r))));
    }
  } else {
    radius_ = length(body.arm) + core_radius(body.start.shape->core());
    from_axis = radius_;
  }
  radius_ *= kRoundedUp;
  // The cross product above is off by some units of the radius, not of itself.
  curvature_ = speed_ * speed_ * (from_axis + 16 * kUnitRoundoff * radius_) * kRoundedUp;
}

double MovingSupport::least_along(const Vec3& n, double time, int& near) const {
  // As the frame sees it that has turned.
  const Vec3 turned_back = speed_ * time == 0 ? n : turned(n, axis_, -(speed_ * time));
  const Vec3 local = rotation_.transpose() * turned_back;
  Vec3 point;
  if (const ConvexPolytope* polytope = body_.start.shape->polytope()) {
    near = support_vertex(*polytope, -local, near);
    point = polytope->vertex(near);
  } else {
    point = support_point(body_.start.shape->core(), -local);
  }
  return turned_back.dot(body_.arm) + local.dot(point);
}

MovingSeparation::MovingSeparation(const MovingShape& a, const MovingShape& b, double duration)
    : motion_a_(a), motion_b_(b), a_(a), b_(b), margins_(a.start.shape->margin() + b.start.shape->margin()) {
  // Pivots: two products, three sums of lengths below `way`. Supports: the turned direction is off by 8u and by the
  // angle's own rounding, 2u of it; two products with matrices; sums of three terms: 40u of the radius.
  const auto way = [&](const MovingShape& body) {
    return length(body.start.pose.translation()) + length(body.arm) + duration * length(body.motion.linear_velocity);
  };
  const auto turn = [&](const MovingSupport& body) {
    return (40 + 2 * body.angular_speed() * duration) * body.radius();
  };
  rounding_ = kUnitRoundoff * (8 * (way(a) + way(b)) + turn(a_) + turn(b_) + 4 * margins_);
}

double MovingSeparation::at(const Vec3& n, double time) {
  const double between = (a_.pivot_at(time) - b_.pivot_at(time)).dot(n);
  return between + a_.least_along(n, time, near_a_) + b_.least_along(-n, time, near_b_) - margins_ - rounding_;
}

double MovingSeparation::closing_bound(const Vec3& n) const {
  const double bound = (motion_b_.motion.linear_velocity - motion_a_.motion.linear_velocity).dot(n) +
                       length(Vec3(n.cross(motion_a_.motion.angular_velocity))) * a_.radius() +
                       length(Vec3(n.cross(motion_b_.motion.angular_velocity))) * b_.radius();
  const double speeds = length(motion_a_.motion.linear_velocity) + length(motion_b_.motion.linear_velocity) +
                        a_.angular_speed() * a_.radius() + b_.angular_speed() * b_.radius();
  return bound + 16 * kUnitRoundoff * speeds;
}

bool apart_throughout(double s0, double s1, double m) {
  if (!(s0 > 0 && s1 > 0 && m >= 0)) return false;
  // With x in [0, 1] along the span: s0 + (s1 - s0) x - m x (1 - x), least at x = (m + s0 - s1) / (2 m).
  const double slope = m + s0 - s1;
  if (slope <= 0 || slope >= 2 * m) return true;
  // Rounded against the claim; the products are compared, so that no quotient is needed.
  return slope * (slope / (4 * m)) * (1 + 16 * kUnitRoundoff) < s0;
}

}  // namespace pd::detail
