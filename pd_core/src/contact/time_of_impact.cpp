#include "pd/contact/time_of_impact.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "pd/depth/scratch.hpp"

namespace pd {

namespace {

/// Newton's method takes over when the gap is this part of the two radii.
constexpr double kNewtonRange = 1e-3;

/// The pair at a time, with what the two methods need.
class MovingPair {
 public:
  MovingPair(const MovingShape& a, const MovingShape& b, Scratch& scratch, const TimeOfImpactSettings& settings)
      : a_(a),
        b_(b),
        scratch_(scratch),
        settings_(settings),
        radius_a_(bounding_radius(*a.start.shape)),
        radius_b_(bounding_radius(*b.start.shape)) {}

  /// Moves to `time` and asks.
  void ask(double time) {
    pose_a_ = pose_at(a_, time);
    pose_b_ = pose_at(b_, time);
    answer_ = penetration_depth({a_.start.shape, pose_a_}, {b_.start.shape, pose_b_}, scratch_, settings_.depth);
    ++queries_;
  }

  /// Signed distance above the allowed depth. It falls no faster along a normal inside than outside: the separation
  /// along any one normal bounds the signed distance from below.
  [[nodiscard]] double clearance() const {
    return settings_.allowed_depth + (answer_.contact == ContactClass::separated ? answer_.distance : -answer_.depth);
  }
  /// No point of A comes nearer to B along the present normal faster than this, at any time.
  [[nodiscard]] double closing_bound() const {
    const Vec3& n = answer_.normal;
    return (b_.motion.linear_velocity - a_.motion.linear_velocity).dot(n) +
           n.cross(a_.motion.angular_velocity).norm() * radius_a_ +
           n.cross(b_.motion.angular_velocity).norm() * radius_b_;
  }
  /// -d/dt of the signed distance.
  [[nodiscard]] double closing_speed() const {
    const Vec3 velocity_a =
        a_.motion.linear_velocity + a_.motion.angular_velocity.cross(answer_.witness_a - pose_a_.translation());
    const Vec3 velocity_b =
        b_.motion.linear_velocity + b_.motion.angular_velocity.cross(answer_.witness_b - pose_b_.translation());
    return (velocity_b - velocity_a).dot(answer_.normal);
  }
  [[nodiscard]] double size() const { return radius_a_ + radius_b_; }
  [[nodiscard]] const PenetrationDepth& answer() const { return answer_; }
  [[nodiscard]] int queries() const { return queries_; }

 private:
  const MovingShape& a_;
  const MovingShape& b_;
  Scratch& scratch_;
  const TimeOfImpactSettings& settings_;
  double radius_a_;
  double radius_b_;
  Pose pose_a_;
  Pose pose_b_;
  PenetrationDepth answer_;
  int queries_ = 0;
};

}  // namespace

Pose pose_at(const MovingShape& body, double time) {
  const Vec3 translation = body.start.pose.translation() + time * body.motion.linear_velocity;
  const double speed = body.motion.angular_velocity.norm();
  const double angle = speed * time;
  if (angle == 0) {
    return Pose::from_trusted_matrix(body.start.pose.rotation(), translation);
  }
  const Mat3 turn = Eigen::AngleAxisd(angle, body.motion.angular_velocity / speed).toRotationMatrix();
  return Pose::from_trusted_matrix(turn * body.start.pose.rotation(), translation);
}

double bounding_radius(const ConvexShape& shape) {
  double core = 0;
  if (const ConvexPolytope* polytope = shape.polytope()) {
    for (int v = 0; v < polytope->num_vertices(); ++v) {
      core = std::max(core, polytope->vertex(v).norm());
    }
  } else if (const auto* ellipsoid = std::get_if<Ellipsoid>(&shape.core())) {
    core = ellipsoid->radii.maxCoeff();
  } else if (const auto* cylinder = std::get_if<Cylinder>(&shape.core())) {
    core = std::hypot(cylinder->radius, cylinder->half_height);
  } else {
    const auto& cone = std::get<Cone>(shape.core());
    core = std::hypot(cone.radius, cone.half_height);
  }
  return core + shape.margin();
}

TimeOfImpact time_of_impact(const MovingShape& a, const MovingShape& b, double duration, Scratch& scratch,
                            const TimeOfImpactSettings& settings) {
  MovingPair pair(a, b, scratch, settings);
  TimeOfImpact result;
  const auto finish = [&](bool hit, double time) {
    result.hit = hit;
    result.time = time;
    result.contact = pair.answer();
    result.queries = pair.queries();
    return result;
  };

  double apart = 0;  // the latest time known to be apart and proved to have no contact before
  pair.ask(apart);
  if (pair.clearance() <= 0) {
    return finish(true, 0);
  }
  // Each pass proves the span up to the new `apart`; the gap shrinks by the share (1 - true speed / bound).
  while (pair.clearance() > std::max(settings.distance_tolerance, kNewtonRange * pair.size())) {
    const double bound = pair.closing_bound();
    const double next = bound > 0 ? apart + pair.clearance() / bound : HUGE_VAL;
    if (next > duration) {
      result.certified = duration;
      return finish(false, duration);
    }
    if (pair.queries() >= settings.max_queries) {
      result.certified = apart;
      return finish(false, apart);
    }
    apart = next;
    pair.ask(apart);
  }
  result.certified = apart;

  // Newton's method; `apart` and `together` bracket the root once a time of overlap is known, until then the bracket is
  // open to the right. Inside it, a step that leaves the bracket is replaced by bisection.
  double together = HUGE_VAL;
  double time = apart;
  while (!(pair.clearance() > 0 && pair.clearance() <= settings.distance_tolerance)) {
    // Aimed at half the tolerance, so that the root is approached from the side where the bodies are apart.
    const double aim = pair.clearance() - 0.5 * settings.distance_tolerance;
    const double speed = pair.closing_speed();
    double next = speed > 0 ? time + aim / speed : HUGE_VAL;
    if (together == HUGE_VAL) {
      if (!(next <= duration)) {
        // Parting, or too slow to meet by the end: look there before saying so, the proof covers [0, certified) only.
        next = duration;
      }
    } else if (!(next > apart && next < together)) {
      next = 0.5 * (apart + together);
    }
    if (next == time || next <= apart || next >= together || pair.queries() >= settings.max_queries) {
      break;
    }
    time = next;
    pair.ask(time);
    if (pair.clearance() > 0) {
      apart = time;
      if (time >= duration && pair.clearance() > settings.distance_tolerance) {
        return finish(false, duration);
      }
    } else {
      together = time;
    }
  }
  if (pair.clearance() <= 0) {
    pair.ask(apart);
  }
  return finish(together < HUGE_VAL || pair.clearance() <= settings.distance_tolerance, apart);
}

}  // namespace pd
