/// @file
/// One order in which a pair is solved, whichever body was named first, and an answer turned around to the caller's.
///
/// Bodies are compared by content, so that neither addresses nor the caller's order of vertices matter, and by
/// comparisons that a power of two does not change.
#pragma once

#include "pd/depth/depth_answer.hpp"
#include "pd/shape/convex_shape.hpp"

namespace pd::detail {

/// Negative, zero (equal numbers) or positive. Transitive.
[[nodiscard]] int compare_bodies(const PosedShape& a, const PosedShape& b);

/// The same answer with the bodies' names exchanged.
void exchange_bodies(PenetrationDepth& answer);

/// Makes negative zeros positive: an exchange negates, and people read the numbers.
void clear_negative_zeros(PenetrationDepth& answer);

}  // namespace pd::detail
