/// @file
/// Two points, a point and a segment, or two segments (the cores of spheres and capsules) in closed form.
///
/// P is a point, a segment or a parallelogram. The nearest two points of the segments give a point of P, whose length
/// bounds the distance from above; the least of P's corners along that direction, or across the parallelogram, bounds
/// it from below. Both are as near to each other as rounding leaves them wherever the points are found well.
#pragma once

#include "depth/features/nearest_of_segments.hpp"
#include "depth/pair/polytope_depth.hpp"
#include "pd/depth/depth_answer.hpp"
#include "pd/shape/convex_shape.hpp"

namespace pd::detail {

/// Whether a shape is a sphere or a point.
inline bool is_sphere(const ConvexShape& shape) {
  const ConvexPolytope* const core = shape.polytope();
  return core != nullptr && core->num_vertices() == 1;
}
[[nodiscard]] inline BracketWidth width_of(const DepthSettings& settings, bool for_contact) {
  return {kCertifiedWidth, for_contact ? settings.contact_tolerance : 0};
}
/// Returns true if the cores' distance may be the margins' sum, as far as rounding tells.
[[nodiscard]] inline bool sign_is_unclear(double lower, double upper, double margin) {
  const double round = 4 * kUnitRoundoff * (upper + margin);
  return lower - margin <= round && upper - margin >= -round;
}
/// Two spheres: Bracket::certified and contact, method automatic. Every step is the same from either side, so that no
/// order of the bodies is asked for. Passes on as below.
bool answer_spheres(const PosedShape& a, const PosedShape& b, const DepthSettings& settings, PenetrationDepth& out);

/// Bracket::certified and contact. Passes on where the cores meet, or nearly, and where bracket or class stay in doubt.
bool answer_slender_pair(const PolytopePair& pair, const DepthSettings& settings, Bracket bracket,
                         PenetrationDepth& out);

/// The same by nearest points that are known, of A and B or, `mirrored`, of B and A.
bool answer_cores_apart(const PolytopePair& pair, NearestOfSegments& cores, bool mirrored,
                        const DepthSettings& settings, Bracket bracket, PenetrationDepth& out);

}  // namespace pd::detail
