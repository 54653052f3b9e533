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

/// Whether the balls round the origins of two polytopes' frames lie more than that apart: what a product, or a host's
/// matrix that is a rotation up to single precision, may change is left to `answer_balls_beyond`.
inline bool balls_may_lie_beyond(const PosedShape& a, const PosedShape& b, double beyond) {
  const ConvexPolytope *const core_a = a.shape->polytope(), *const core_b = b.shape->polytope();
  if (core_a == nullptr || core_b == nullptr) return false;
  const double most = beyond + (a.shape->margin() + b.shape->margin()) + (core_a->radius() + core_b->radius());
  return (b.pose.translation() - a.pose.translation()).squaredNorm() > (1 + 0x1p-8) * most * most;
}
/// The same as below by these balls. Every step is the same from either side, so that no order of the bodies is asked
/// for; no memory is read or written.
[[nodiscard]] bool answer_balls_beyond(const PosedShape& a, const PosedShape& b, double beyond, PenetrationDepth& out);

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
