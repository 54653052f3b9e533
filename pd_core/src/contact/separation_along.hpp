/// @file
/// The distance of two moving bodies along one direction, which stands still or turns with one of them, is computed as
/// a function of time with a bound on its curvature.
#pragma once

#include <array>

#include "numeric/turn.hpp"
#include "pd/contact/time_of_impact.hpp"

namespace pd::detail {

/// One body of the pair: its core's support at any time.
class MovingSupport {
 public:
  explicit MovingSupport(const MovingShape& body);

  /// min <x(time) - pivot(time), n> over the core. `near` is the vertex that answered last.
  [[nodiscard]] double least_along(const Vec3& n, double time, int& near);
  [[nodiscard]] Vec3 pivot_at(double time) const { return pivot_ + time * body_.motion.linear_velocity; }
  /// Bounds the acceleration of every point of the core about the pivot: |omega|^2 times its distance from the axis of
  /// the turn. A body of revolution is seen by a frame that does not spin about the body's own axis.
  [[nodiscard]] double curvature() const { return curvature_; }
  /// >= the distance of every point of the core from the pivot.
  [[nodiscard]] double radius() const { return radius_; }
  [[nodiscard]] double angular_speed() const { return speed_; }
  [[nodiscard]] const Vec3& axis() const { return axis_; }
  /// Bounds the distance of every point of the core from `point`, at time 0.
  [[nodiscard]] double farthest_from(const Vec3& point) const;

 private:
  /// Returns the turn back from `time` to 0. The last two are kept: the end of a duration is asked for again and again.
  [[nodiscard]] const Turn& turn_back(double time);

  struct TurnAt {
    double time;
    Turn turn;
  };

  const MovingShape& body_;
  std::array<TurnAt, 2> turns_{TurnAt{-1, {0, 0}}, TurnAt{-1, {0, 0}}};  ///< the newest first
  Mat3 rotation_;
  Vec3 pivot_;
  Vec3 axis_ = Vec3::Zero();
  double speed_ = 0;
  double radius_ = 0;
  double curvature_ = 0;
};

/// A direction that stands still or turns with a body of the pair. It is the unit vector n at the time `since`.
struct MovingDirection {
  enum class Frame { common, a, b };
  Vec3 n;
  double since = 0;
  Frame frame = Frame::common;
};

/// Both bodies. Lengths are less the margins.
class MovingSeparation {
 public:
  using Frame = MovingDirection::Frame;

  /// @param duration  the times asked for lie in [0, duration].
  MovingSeparation(const MovingShape& a, const MovingShape& b, double duration);

  /// A lower bound of s(time) = min_A <p, n> - max_B <q, n> - margins at `time`, for the direction as it is then:
  /// within `2 * rounding()` of s.
  [[nodiscard]] double at(const MovingDirection& direction, double time);
  /// Every pair of points has |g''| <= this, so that s, the least of them, lies below its chord over a span h by
  /// curvature * x (h - x) / 2 at most. Along a direction that turns with A by omega, the points of A stand still, and
  /// a point of B is at u from the pivot of A: g'' is the part along n of u'' - 2 omega x u' + omega x (omega x u).
  [[nodiscard]] double curvature(Frame frame);
  /// No pair of points comes nearer along the direction faster than this, at any time.
  [[nodiscard]] double closing_bound(const MovingDirection& direction);
  /// True if directions of the frame turn.
  [[nodiscard]] bool turns(Frame frame) const {
    return frame != Frame::common && (frame == Frame::a ? a_ : b_).angular_speed() > 0;
  }
  /// The error of `at`, and how far a pose of doubles is from the motion that it stands for.
  [[nodiscard]] double rounding() const { return rounding_; }

 private:
  /// Bounds the distances and motions of the points of one body as the pivot of the other body sees them.
  struct Seen {
    double angular_speed = -1;  ///< of the pivot's body; negative: not computed yet
    double distance = 0;
    double speed = 0;
    double acceleration = 0;
    double rounding = 0;  ///< added to the error of `at` by a direction that turns
  };
  [[nodiscard]] const Seen& seen_from(Frame frame);

  const MovingShape& motion_a_;
  const MovingShape& motion_b_;
  double duration_;
  MovingSupport a_;
  MovingSupport b_;
  double margins_;
  double rounding_;
  Seen from_a_;
  Seen from_b_;
  int near_a_ = -1;
  int near_b_ = -1;
};

/// Whether s > 0 on a whole span of time, for s0 and s1 > 0 at its ends and m = curvature * span^2 / 2.
[[nodiscard]] bool apart_throughout(double s0, double s1, double m);

}  // namespace pd::detail
