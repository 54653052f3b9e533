/// @file
/// When two moving bodies first touch.
///
/// Each body turns about the origin of its own frame at a constant angular velocity while that origin moves at a
/// constant velocity. Two tools work together: *conservative advancement* (B. Mirtich, "Impulse-based dynamic
/// simulation", 1996) proves a time span free of contact, and *Newton's method inside a bracket* finds the root of the
/// signed distance.
///
/// With n the unit normal of the answer at time t and d the distance, every point p of body X at r from its origin
/// moves along n no faster than v.n + |n x omega| |r| at any later time, so nothing touches before t + d / (closing
/// speed of the origins along n + |n x omega_a| r_a + |n x omega_b| r_b), r the bodies' radii. The signed distance has
/// the derivative (velocity of A's witness - velocity of B's witness) . n almost everywhere.
#pragma once

#include "pd/depth/penetration_depth.hpp"

namespace pd {

/// Unit of length per unit of time, and radians per unit of time; common frame.
struct RigidMotion {
  Vec3 linear_velocity = Vec3::Zero();
  Vec3 angular_velocity = Vec3::Zero();
};

struct MovingShape {
  PosedShape start;  ///< at time 0
  RigidMotion motion;
};

/// Where the body is at time t: exp(t [omega]) R and translation + t v.
[[nodiscard]] Pose pose_at(const MovingShape& body, double time);

/// Largest distance of a point of the shape from the origin of its frame, margin included.
[[nodiscard]] double bounding_radius(const ConvexShape& shape);

struct TimeOfImpactSettings {
  /// The gap at which the bodies count as meeting, > 0, unit of length.
  double distance_tolerance = 1e-9;
  /// >= 0: looks for the first time at which the bodies are deeper than this in each other, for pairs that are in
  /// contact from the start. "Apart" below then means: not as deep as this.
  double allowed_depth = 0;
  /// A cap on the number of distance queries; when it is reached the answer is what is proved by then.
  int max_queries = 200;
  DepthSettings depth;
};

struct TimeOfImpact {
  bool hit = false;
  /// The bodies are apart at `time`, by at most the tolerance; the duration when there is no hit; 0 when they are not
  /// apart at the start.
  double time = 0;
  /// No contact happens in [0, certified).
  double certified = 0;
  /// The answer at `time` (or at the last time that was looked at, without a hit).
  PenetrationDepth contact;
  int queries = 0;  ///< distance queries made
};

/// First contact within [0, duration].
///
/// `time - certified` is at most what the last thousandth of the bodies' size takes: up to there advancement proves,
/// from there Newton's method finds the root (quadratically, 2 to 5 queries). Requires duration >= 0.
[[nodiscard]] TimeOfImpact time_of_impact(const MovingShape& a, const MovingShape& b, double duration, Scratch& scratch,
                                          const TimeOfImpactSettings& settings = {});

}  // namespace pd
