/// @file
/// How far two moving bodies are apart along one fixed direction, as a function of time with a bound on its curvature.
#pragma once

#include "pd/contact/time_of_impact.hpp"

namespace pd::detail {

/// One body of the pair: its core's support at any time.
class MovingSupport {
 public:
  explicit MovingSupport(const MovingShape& body);

  /// min <x(time) - pivot(time), n> over the core. `near` is the vertex that answered last.
  [[nodiscard]] double least_along(const Vec3& n, double time, int& near) const;
  [[nodiscard]] Vec3 pivot_at(double time) const { return pivot_ + time * body_.motion.linear_velocity; }
  /// >= |omega|^2 times the distance of every point of the core from the axis through the pivot.
  [[nodiscard]] double curvature() const { return curvature_; }
  /// >= the distance of every point of the core from the pivot.
  [[nodiscard]] double radius() const { return radius_; }
  [[nodiscard]] double angular_speed() const { return speed_; }

 private:
  const MovingShape& body_;
  Mat3 rotation_;
  Vec3 pivot_;
  Vec3 axis_ = Vec3::Zero();
  double speed_ = 0;
  double radius_ = 0;
  double curvature_ = 0;
};

/// Both bodies. Lengths are less the margins.
class MovingSeparation {
 public:
  /// @param duration  the times asked for lie in [0, duration].
  MovingSeparation(const MovingShape& a, const MovingShape& b, double duration);

  /// A lower bound of min_A <p, n> - max_B <q, n> - margins at `time`, for a unit vector n: within `2 * rounding()` of
  /// it.
  [[nodiscard]] double at(const Vec3& n, double time);
  /// Every pair of points has |g''| <= this along any unit direction, so that s, the least of them, lies below its
  /// chord over a span h by curvature * x (h - x) / 2 at most.
  [[nodiscard]] double curvature() const { return a_.curvature() + b_.curvature(); }
  /// No pair of points comes nearer along n faster than this, at any time.
  [[nodiscard]] double closing_bound(const Vec3& n) const;
  /// The error of `at`, and how far a pose of doubles is from the motion that it stands for.
  [[nodiscard]] double rounding() const { return rounding_; }

 private:
  const MovingShape& motion_a_;
  const MovingShape& motion_b_;
  MovingSupport a_;
  MovingSupport b_;
  double margins_;
  double rounding_;
  int near_a_ = -1;
  int near_b_ = -1;
};

/// Whether s > 0 on a whole span of time, for s0 and s1 > 0 at its ends and m = curvature * span^2 / 2.
[[nodiscard]] bool apart_throughout(double s0, double s1, double m);

}  // namespace pd::detail
