/// @file
/// Whether two bodies are farther apart than asked, by one separating plane: what a hit of a broadphase asks first.
#pragma once

#include "depth/pair/scratch_buffers.hpp"
#include "pd/depth/depth_answer.hpp"
#include "pd/shape/convex_shape.hpp"

namespace pd {
class WarmCertificate;
}

namespace pd::detail {

/// Answers and returns true where a certified plane shows more than `settings.beyond` between the bodies; else leaves
/// `out` alone but for its statistics, and nothing is known.
///
/// The plane of the last frame first, then the steps of Gilbert, Johnson and Keerthi 1988, each from the point of a
/// simplex in P that is closest to the origin: given up where that point is no farther than asked, or after a few
/// supports.
[[nodiscard]] bool answer_beyond(const PosedShape& a, const PosedShape& b, const DepthSettings& settings,
                                 ScratchBuffers& buffers, WarmCertificate* warm, PenetrationDepth& out);

/// The plane of an answer that the full query gave, for the next frame.
void remember_plane(const PenetrationDepth& out, WarmCertificate& warm);

}  // namespace pd::detail
