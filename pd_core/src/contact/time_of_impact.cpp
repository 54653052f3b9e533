#include "pd/contact/time_of_impact.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <utility>

#include "contact/separation_along.hpp"
#include "numeric/floating_point_guard.hpp"
#include "numeric/length.hpp"
#include "numeric/turn.hpp"
#include "pd/depth/scratch.hpp"
#include "shape/core_radius.hpp"

namespace pd {

namespace {

/// Spans that are tried along one normal before the next distance query, and shortenings of one span: supports cost a
/// few hundredths of a query, and a normal is worth following while it still tells half of the distance.
constexpr int kSpansPerNormal = 8;
constexpr int kShortenings = 24;
/// A direction that proves this share of what is left of the duration is followed alone.
constexpr double kFarEnough = 0.25;
/// A horizon that doubles cannot resolve is cut to this share of its span at most. It grows by the inverse.
constexpr double kShorterHorizon = 1.0 / 16;

/// The pair at a time: the distance and what follows from its normal.
class MovingPair {
 public:
  MovingPair(const MovingShape& a, const MovingShape& b, double duration, Scratch& scratch,
             const TimeOfImpactSettings& settings)
      : a_(a),
        b_(b),
        scratch_(scratch),
        settings_(settings),
        separation_(std::in_place, a, b, duration),
        horizon_(duration) {}

  /// Starts with the pair's answer at time 0.
  void begin() {
    if (settings_.at_start == nullptr) return ask(0);
    answer_ = *settings_.at_start;
  }

  /// Moves to `time` and asks.
  void ask(double time) {
    answer_ = penetration_depth({a_.start.shape, pose_at(a_, time)}, {b_.start.shape, pose_at(b_, time)}, scratch_,
                                settings_.depth);
    ++queries_;
  }

  /// Signed distance above the allowed depth. The separation along any one normal bounds the signed distance from
  /// below, inside as well as outside.
  [[nodiscard]] double clearance() const { return settings_.allowed_depth + answer_.signed_distance(); }

  /// Proofs reach up to this time. The rounding that they allow for grows with it.
  [[nodiscard]] double horizon() const { return horizon_; }

  /// Moves the horizon nearer to `time`: to some times what the pair needs to meet. False if that leaves as much
  /// rounding as before.
  [[nodiscard]] bool shorten_horizon(double time) {
    const double closing = separation_->closing_bound({answer_.normal, time, Frame::common});
    const double meeting = closing > 0 ? 8 * clearance() / closing : HUGE_VAL;
    const double horizon = time + std::min(meeting, kShorterHorizon * (horizon_ - time));
    if (!(horizon > time && horizon < horizon_)) return false;
    const double before = rounding();
    set_horizon(horizon);
    return rounding() <= 0.5 * before;
  }

  /// Moves the horizon away again once the pair is proved apart up to it.
  void lengthen_horizon(double duration) { set_horizon(std::min(duration, horizon_ / kShorterHorizon)); }

  /// The latest time after `time` up to which the present normal proves the pair apart: the horizon, or one where
  /// what is left along the normal is about `goal`, or where the normal is worth no more. The normal stands still, or
  /// turns with one of the bodies.
  [[nodiscard]] double follow_normal(double time, double goal) {
    struct Lead {
      detail::MovingDirection direction;
      double left;  ///< at the end
    };
    std::array<Lead, 3> leads;
    std::size_t count = 0;
    const double now = clearance_along({answer_.normal, time, Frame::common}, time);
    for (const Frame frame : {Frame::common, Frame::a, Frame::b}) {
      if (frame != Frame::common && !separation_->turns(frame)) continue;
      const detail::MovingDirection direction{answer_.normal, time, frame};
      const double left = clearance_along(direction, horizon_);
      if (left >= 0.5 * goal && detail::apart_throughout(now, left, bulge(frame, horizon_ - time))) return horizon_;
      leads[count++] = {direction, left};
    }
    // The direction with the most left at the end is followed first.
    const auto end = leads.begin() + static_cast<std::ptrdiff_t>(count);
    std::sort(leads.begin(), end, [](const Lead& x, const Lead& y) {
      return x.left != y.left ? x.left > y.left : x.direction.frame < y.direction.frame;
    });
    double latest = time;
    for (auto lead = leads.begin(); lead != end && latest - time < kFarEnough * (horizon_ - time); ++lead) {
      latest = std::max(latest, follow(lead->direction, goal));
    }
    return latest;
  }

  /// A time between one that is `apart` and one whose pose of doubles touches where the gap is within the tolerance, or
  /// the last that was found apart. Moves there and asks. The span is halved.
  [[nodiscard]] double last_apart(double apart, double touching) {
    ask(apart);
    while (clearance() > settings_.distance_tolerance && queries_ < settings_.max_queries) {
      const double middle = 0.5 * (apart + touching);
      if (!(middle > apart && middle < touching)) break;
      ask(middle);
      if (clearance() > 0) {
        apart = middle;
      } else {
        touching = middle;
        ask(apart);
      }
    }
    return apart;
  }

  [[nodiscard]] double rounding() const { return separation_->rounding(); }
  [[nodiscard]] const PenetrationDepth& answer() const { return answer_; }
  [[nodiscard]] int queries() const { return queries_; }

 private:
  using Frame = detail::MovingDirection::Frame;

  void set_horizon(double horizon) {
    separation_.emplace(a_, b_, horizon);
    horizon_ = horizon;
  }

  [[nodiscard]] double clearance_along(const detail::MovingDirection& direction, double time) {
    return settings_.allowed_depth + separation_->at(direction, time);
  }

  /// Returns the m of `apart_throughout`.
  [[nodiscard]] double bulge(Frame frame, double span) { return 0.5 * separation_->curvature(frame) * span * span; }

  /// Does what `follow_normal` does for one direction, from the time `since` on.
  [[nodiscard]] double follow(const detail::MovingDirection& direction, double goal) {
    double time = direction.since;
    double left = clearance_along(direction, time);
    const double worthless = 0.25 * left;
    for (int i = 0; i < kSpansPerNormal && left > 0 && time < horizon_; ++i) {
      const double next = one_span(direction, time, left, goal);
      if (!(next > time)) break;
      time = next;
      if (left <= worthless || left <= 2 * goal) break;
    }
    return time;
  }

  /// One proved span from `time`, where `left` > 0 is left along the normal. Updates `left`. The span is shortened
  /// until the proof holds; that of first order (Mirtich's) holds for certain.
  [[nodiscard]] double one_span(const detail::MovingDirection& direction, double time, double& left, double goal) {
    const double bound = separation_->closing_bound(direction);
    // Rounded down: the quotient and the sum with the time.
    const double certain = bound > 0 ? 0.999 * left / bound : HUGE_VAL;
    double span = horizon_ - time;
    if (certain >= span) {
      left = clearance_along(direction, horizon_);
      return horizon_;
    }
    for (int k = 0; k < kShortenings && span > certain; ++k) {
      const double end = k == 0 ? horizon_ : time + span;
      const double then = clearance_along(direction, end);
      if (then >= 0.5 * goal) {
        if (detail::apart_throughout(left, then, bulge(direction.frame, end - time))) {
          left = then;
          return end;
        }
        span *= 0.5;
      } else {
        // Where the chord meets the goal; without rotation s is concave and lies above the chord, so that this end
        // holds. Bounded away from both ends, so that convex stretches shorten, too.
        span *= std::clamp((left - goal) / (left - then), k < 4 ? 1e-3 : 0.1, 0.9);
      }
    }
    const double end = std::min(time + certain, horizon_);
    left = clearance_along(direction, end);
    return end;
  }

  const MovingShape& a_;
  const MovingShape& b_;
  Scratch& scratch_;
  const TimeOfImpactSettings& settings_;
  std::optional<detail::MovingSeparation> separation_;  ///< emplaced again for each horizon
  double horizon_;
  PenetrationDepth answer_;
  int queries_ = 0;
};

/// The same rotation at another place.
Pose moved(const Pose& pose, const Vec3& translation) {
  if (pose.is_quaternion()) {
    if (auto exact = Pose::from_quaternion(pose.quaternion_wxyz(), translation)) return *exact;
  }
  return Pose::from_trusted_matrix(pose.rotation(), translation);
}

}  // namespace

Pose pose_at(const MovingShape& body, double time) {
  if (time == 0) return body.start.pose;
  const Vec3 way = time * body.motion.linear_velocity;
  const double speed = detail::length(body.motion.angular_velocity);
  const double angle = speed * time;
  if (angle == 0) return moved(body.start.pose, body.start.pose.translation() + way);
  const Mat3 turn = detail::rotation_about(body.motion.angular_velocity / speed, angle);
  const Vec3 translation = body.start.pose.translation() + way + (turn * body.arm - body.arm);
  return Pose::from_trusted_matrix(turn * body.start.pose.rotation(), translation);
}

double curvature_bound(const MovingShape& body) { return detail::MovingSupport(body).curvature(); }

double bounding_radius(const ConvexShape& shape) { return detail::core_radius(shape.core()) + shape.margin(); }

TimeOfImpact time_of_impact(const MovingShape& a, const MovingShape& b, double duration, Scratch& scratch,
                            const TimeOfImpactSettings& settings) {
  const detail::FloatingPointGuard guard;
  MovingPair pair(a, b, duration, scratch, settings);
  TimeOfImpact result;
  const auto finish = [&](bool hit, double time, bool reached) {
    result.hit = hit;
    result.time = time;
    result.reached = reached;
    result.contact = pair.answer();
    result.queries = pair.queries();
    return result;
  };

  double time = 0;  // no contact in [0, time), and apart there
  pair.begin();
  if (pair.clearance() <= 0) return finish(true, 0, true);
  // A pair that starts closer than the tolerance meets only if it comes closer still.
  const double tolerance = std::min(settings.distance_tolerance, 0.5 * pair.clearance());
  for (;;) {
    result.certified = time;
    const double clearance = pair.clearance();
    // Doubles cannot tell a smaller gap from contact at the coordinates of the horizon.
    if (clearance <= std::max(tolerance, 8 * pair.rounding())) {
      if (clearance > settings.distance_tolerance && pair.shorten_horizon(time)) continue;
      return finish(true, time, clearance <= settings.distance_tolerance);
    }
    if (pair.queries() >= settings.max_queries) return finish(true, time, false);
    const double next = pair.follow_normal(time, std::max(0.5 * tolerance, 2 * pair.rounding()));
    if (next >= duration) {
      result.certified = duration;
      if (settings.contact_at_end && duration > 0) pair.ask(duration);
      return finish(false, duration, true);
    }
    if (!(next > time)) {
      if (pair.shorten_horizon(time)) continue;
      return finish(true, time, false);
    }
    if (next >= pair.horizon()) pair.lengthen_horizon(duration);
    const double proved = time;
    time = next;
    pair.ask(time);
    // The pose of doubles may touch where the motion, proved apart, does not.
    if (pair.clearance() <= 0) {
      result.certified = next;
      time = pair.last_apart(proved, next);
      return finish(true, time, pair.clearance() <= settings.distance_tolerance);
    }
  }
}

}  // namespace pd
