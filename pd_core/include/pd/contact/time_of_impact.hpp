/// @file
/// When two moving bodies first touch.
///
/// Each body turns about a point of its own (the origin of its frame, unless said otherwise) at a constant angular
/// velocity while that point moves at a constant velocity. Time advances by proof only. Along a fixed unit direction
/// n the bodies are apart by s(t) = min_A <p(t), n> - max_B <q(t), n>, which is the least of functions g of single
/// pairs of points. A point at distance r from its axis has |g''| <= |omega|^2 r, so between two times whose s is known
///
///     s(t) >= linear interpolation - (t - t0) (t1 - t) / 2 * (|omega_a|^2 r_a + |omega_b|^2 r_b),
///
/// which costs two supports a body for a whole span of time. Without rotation s is concave and the span may have any
/// length. The normal of the distance at the span's start is n. It stands still or, if that proves more, turns with one
/// of the bodies: a face that rocks on an edge stays apart along its own normal. The bound on g'' then has the terms of
/// a frame that turns. The function s is followed to where it has nearly vanished, and the next distance gives the next
/// n. This is B. Mirtich's conservative advancement ("Impulse-based dynamic simulation", 1996), with a bound of second
/// order in place of his of first, along E. Catto's separation functions ("Continuous collision", GDC 2013), with a
/// proof in place of his root finding.
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
  /// From the point about which the body turns to the origin of the shape's frame, at time 0: zero for a shape that
  /// turns about its own origin. The linear velocity is that of the point.
  Vec3 arm = Vec3::Zero();
};

/// The pose of the shape at time t: exp(t [omega]) R and translation - arm + t v + exp(t [omega]) arm. At time 0, and
/// without rotation, the rotation is the start's own, to the bit.
[[nodiscard]] Pose pose_at(const MovingShape& body, double time);

/// Bounds how far a moving shape bends off a chord. The least coordinate of the shape along a unit direction is a
/// function of time. Over a span h it lies below its chord by curvature_bound * x (h - x) / 2 at most, at the time x
/// after the span began. Unit of length per unit of time squared. For a cylinder or cone that turns about its own axis
/// it is rounding alone. Time O(v) in v vertices of a polytope.
[[nodiscard]] double curvature_bound(const MovingShape& body);

/// Largest distance of a point of the shape from the origin of its frame, margin included.
[[nodiscard]] double bounding_radius(const ConvexShape& shape);

struct TimeOfImpactSettings {
  /// The gap at which the bodies count as meeting, > 0, unit of length.
  double distance_tolerance = 1e-9;
  /// The first time is sought at which the bodies are deeper in each other than this, >= 0; for pairs in contact from
  /// the start. "Apart" below then means: not as deep as this.
  double allowed_depth = 0;
  /// A cap on the number of distance queries; when it is reached the answer is what is proved by then. Long edges that
  /// are nearly parallel and turn fast against each other take up to 300: a normal serves them for a short while only.
  int max_queries = 1000;
  /// Without a hit, whether `contact` is asked for at the end of the duration; else it is of the last time looked at.
  bool contact_at_end = true;
  /// The pair's answer at time 0 with the settings below, if the caller has it; else null. It saves one query.
  const PenetrationDepth* at_start = nullptr;
  DepthSettings depth;
};

struct TimeOfImpact {
  bool hit = false;
  /// The bodies are apart at `time`, by at most the tolerance; the duration when there is no hit; 0 when they are not
  /// apart at the start.
  double time = 0;
  /// No contact happens in [0, certified): proved, rounding of times, poses and supports included. With a hit it equals
  /// `time`, without one the duration.
  double certified = 0;
  /// False if the cap on queries, or the resolution of doubles at these coordinates, left a gap above the tolerance
  /// at `time`. It is then open if the bodies meet afterwards, and `hit` is true to be on the safe side.
  bool reached = true;
  PenetrationDepth contact;  ///< the answer at `time`
  int queries = 0;           ///< distance queries made
};

/// First contact within [0, duration].
///
/// Passing each other closer than the tolerance may count as a hit; nothing deeper is missed. Requires duration >= 0
/// and velocities whose way in that time stays within the range of poses. Queries: 3 to 14 in the mean
/// of five families (`impact_pairs`), one for pairs that the first normal keeps apart for all the time; some supports
/// between two queries.
[[nodiscard]] TimeOfImpact time_of_impact(const MovingShape& a, const MovingShape& b, double duration, Scratch& scratch,
                                          const TimeOfImpactSettings& settings = {});

}  // namespace pd
