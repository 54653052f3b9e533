/// @file
/// First contact of two moving polytopes by bisection of time: no distance, no search for a normal, no code of the
/// library beyond the public types.
///
/// At the middle of a span of time the separating axes of the two polytopes (facet normals, products of edges) give a
/// lower bound s of their distance, positive exactly when they are apart. No point moves faster along any direction
/// than |v| + |omega| r, so that s above the relative speed times half the span excludes contact within it. Spans that
/// are not excluded are halved, the earlier half first, down to the resolution.
#pragma once

#include "pd/contact/time_of_impact.hpp"

namespace pd::oracle {

struct FirstImpact {
  bool hit = false;
  /// The start of the first span of the resolution's length that cannot be excluded; the duration without one.
  double time = 0;
};

/// Requires polytopes without margins, in their own frames' origins turning (arms are honoured). `resolution` > 0.
[[nodiscard]] FirstImpact first_impact(const MovingShape& a, const MovingShape& b, double duration, double resolution);

/// The largest separation along any separating axis at `time`; > 0 exactly when the two are apart, and then a lower
/// bound of their distance.
[[nodiscard]] double axis_separation(const MovingShape& a, const MovingShape& b, double time);

}  // namespace pd::oracle
