#include "contact/separation_along.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <variant>

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

std::optional<int> axis_of_revolution(const ConvexShape::Core& core) {
  if (const auto* cylinder = std::get_if<Cylinder>(&core)) return cylinder->axis;
  if (const auto* cone = std::get_if<Cone>(&core)) return cone->axis;
  return std::nullopt;
}

/// Bounds the accelerations of a body of revolution whose axis a turns about the unit vector e, as a share of the
/// body's radius; given e x a. The body is the same in the frame that follows a without spinning about it. That frame
/// turns by w = e - (e . a) a and w' = -(e . a) (e x a), so that no acceleration in it is larger than |w|^2 + |w'| = |e
/// x a| (|e x a| + |e . a|) <= sqrt(2) |e x a| times the radius.
double across_revolution(const Vec3& e_cross_a) { return std::min(1.0, 1.4142136 * length(e_cross_a)); }

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
    const double of_core = core_radius(body.start.shape->core());
    radius_ = length(body.arm) + of_core;
    from_axis = radius_;
    if (const std::optional<int> own = axis_of_revolution(body.start.shape->core())) {
      from_axis = length(Vec3(axis_.cross(body.arm))) + across_revolution(axis_.cross(rotation_.col(*own))) * of_core;
    }
  }
  radius_ *= kRoundedUp;
  // The cross products above are off by some units of the radius, not of themselves.
  curvature_ = speed_ * speed_ * (from_axis + 64 * kUnitRoundoff * radius_) * kRoundedUp;
}

const Turn& MovingSupport::turn_back(double time) {
  if (turns_[0].time != time) {
    std::swap(turns_[0], turns_[1]);
    if (turns_[0].time != time) turns_[0] = {time, turn_by(-(speed_ * time))};
  }
  return turns_[0].turn;
}

double MovingSupport::least_along(const Vec3& n, double time, int& near) {
  // As the frame sees it that has turned.
  const Vec3 turned_back = speed_ * time == 0 ? n : turned(n, axis_, turn_back(time));
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

double MovingSupport::farthest_from(const Vec3& point) const {
  const Vec3 offset = body_.start.pose.translation() - point;
  double farthest = 0;
  if (const ConvexPolytope* polytope = body_.start.shape->polytope()) {
    for (int v = 0; v < polytope->num_vertices(); ++v) {
      farthest = std::max(farthest, length(Vec3(offset + rotation_ * polytope->vertex(v))));
    }
  } else {
    farthest = length(offset) + core_radius(body_.start.shape->core());
  }
  return (farthest + 16 * kUnitRoundoff * (length(body_.start.pose.translation()) + length(point))) * kRoundedUp;
}

MovingSeparation::MovingSeparation(const MovingShape& a, const MovingShape& b, double duration)
    : motion_a_(a),
      motion_b_(b),
      duration_(duration),
      a_(a),
      b_(b),
      margins_(a.start.shape->margin() + b.start.shape->margin()) {
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

const MovingSeparation::Seen& MovingSeparation::seen_from(Frame frame) {
  Seen& seen = frame == Frame::a ? from_a_ : from_b_;
  if (seen.angular_speed >= 0) return seen;
  const MovingSupport& own = frame == Frame::a ? a_ : b_;
  const MovingSupport& other = frame == Frame::a ? b_ : a_;
  const double linear = length(Vec3(motion_a_.motion.linear_velocity - motion_b_.motion.linear_velocity));
  seen.angular_speed = own.angular_speed();
  seen.speed = (linear + other.angular_speed() * other.radius()) * kRoundedUp;
  seen.distance = (other.farthest_from(own.pivot_at(0)) + duration_ * seen.speed) * kRoundedUp;
  seen.acceleration = other.curvature();
  // The direction is off by 8u and by the rounding of its angle, and its length is off as much.
  const double angle = own.angular_speed() * duration_;
  seen.rounding = kUnitRoundoff * (32 + 4 * angle) * (seen.distance + own.radius() + margins_);
  return seen;
}

double MovingSeparation::at(const MovingDirection& direction, double time) {
  Vec3 n = direction.n;
  double error = rounding_;
  if (turns(direction.frame) && time != direction.since) {
    const MovingSupport& body = direction.frame == Frame::a ? a_ : b_;
    n = turned(n, body.axis(), body.angular_speed() * (time - direction.since));
    error += seen_from(direction.frame).rounding;
  }
  const double between = (a_.pivot_at(time) - b_.pivot_at(time)).dot(n);
  return between + a_.least_along(n, time, near_a_) + b_.least_along(-n, time, near_b_) - margins_ - error;
}

double MovingSeparation::curvature(Frame frame) {
  if (!turns(frame)) return a_.curvature() + b_.curvature();
  const Seen& seen = seen_from(frame);
  const double omega = seen.angular_speed;
  return (seen.acceleration + omega * (2 * seen.speed + omega * seen.distance)) * kRoundedUp;
}

double MovingSeparation::closing_bound(const MovingDirection& direction) {
  if (turns(direction.frame)) {
    const Seen& seen = seen_from(direction.frame);
    return (seen.speed + seen.angular_speed * seen.distance) * kRoundedUp;
  }
  const Vec3& n = direction.n;
  const double bound = (motion_b_.motion.linear_velocity - motion_a_.motion.linear_velocity).dot(n) +
                       length(Vec3(n.cross(motion_a_.motion.angular_velocity))) * a_.radius() +
                       length(Vec3(n.cross(motion_b_.motion.angular_velocity))) * b_.radius();
  const double speeds = length(motion_a_.motion.linear_velocity) + length(motion_b_.motion.linear_velocity) +
                        a_.angular_speed() * a_.radius() + b_.angular_speed() * b_.radius();
  return bound + 16 * kUnitRoundoff * speeds;
}

bool apart_throughout(double s0, double s1, double m) {
  // A bound that has overflowed proves nothing.
  if (!(s0 > 0 && s1 > 0 && m >= 0 && m < HUGE_VAL)) return false;
  // With x in [0, 1] along the span: s0 + (s1 - s0) x - m x (1 - x), least at x = (m + s0 - s1) / (2 m).
  const double slope = m + s0 - s1;
  if (slope <= 0 || slope >= 2 * m) return true;
  // Rounded against the claim; the products are compared, so that no quotient is needed.
  return slope * (slope / (4 * m)) * (1 + 16 * kUnitRoundoff) < s0;
}

}  // namespace pd::detail
