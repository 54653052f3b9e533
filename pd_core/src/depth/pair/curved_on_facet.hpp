/// @file
/// Bracket::contact: a curved body on a facet of a polytope that is known beforehand.
#pragma once

#include "depth/difference/smooth_difference.hpp"
#include "pd/depth/depth_answer.hpp"
#include "pd/depth/warm_certificate.hpp"

namespace pd::detail {

/// Answers for a curved body on the facet of a polytope that it lay on in the last frame, or on a polygon. False, and
/// nothing said, where there is no such facet or it does not certify an interval of at most `width`.
///
/// @param difference  of the whole cores. @param warm  the memory of the pair, or null.
bool curved_on_facet(const PosedShape& a, const PosedShape& b, const SmoothDifference& difference, double width,
                     WarmCertificate* warm, PenetrationDepth& out);

}  // namespace pd::detail
