/// @file
/// A line that is moved until it meets P = B + (-A), and on until it leaves it, without building P: [A], remark after
/// Corollary 3.3; [D] Lemma 5.3.
///
/// Seen along the line everything is planar: P is a convex polygon Q, its shadow, the line a point that runs on a ray.
/// A chord of Q across the ray's line is pushed outwards by supports of P until no vertex lies beyond it (the planar
/// portal search); its crossing is where the point enters or leaves Q. Every choice is the exact sign of a determinant.
///
/// Departure: [D] descends a hierarchy of P in O(log n); P is not at hand here, and the chord search asks for O(log)
/// supports by measurement only.
///
/// [A] Agarwal, Guibas, Har-Peled, Rabinovitch, Sharir, "Penetration depth of two convex polytopes in 3D", 2000.
/// [D] Dobkin, Hershberger, Kirkpatrick, Suri, "Computing the intersection-depth of polyhedra", 1993.
#pragma once

#include <cstdint>

#include "pd/depth/penetration_depth.hpp"
#include "pd/numeric/expected.hpp"

namespace pd {

/// The times t >= 0 at which the line {point + t motion / |motion| + s direction} meets P (touching it counts): all
/// from `first` to `last`, lengths in the unit of the input.
struct TranslatingLine {
  bool meets = false;  ///< exact; false: all figures below are 0
  /// Both 0 where the line meets P at the start; else neighbouring doubles round the exact value, or equal.
  double first_lower = 0, first_upper = 0;
  double last_lower = 0, last_upper = 0;  ///< the same; upper is infinite where the value exceeds the range of doubles
  std::int64_t support_calls = 0;
};

/// Exact on the stored numbers and poses, whatever the affine dimensions of the bodies.
///
/// @param point      any finite point of the line at t = 0, within 1e300.
/// @param direction  of the line, any finite length but zero.
/// @param motion     any finite vector that is not parallel to the line.
/// @return ErrorCode::non_finite ("point", "direction", "motion"), out_of_range ("point"), zero_direction ("direction",
/// or "motion" when it does not move the line), unsupported when a shape is smooth or has a margin.
/// Time: O(log) supports, measured; at most one for every edge of Q.
[[nodiscard]] Expected<TranslatingLine> translating_line_in_difference(const PosedShape& a, const PosedShape& b,
                                                                       const Vec3& point, const Vec3& direction,
                                                                       const Vec3& motion);

}  // namespace pd
