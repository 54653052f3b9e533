/// @file
/// Depth and distance of two (rounded) polytopes: doubles with certificates first, exact arithmetic behind them.
#pragma once

#include "depth/certificate/exact_answer.hpp"
#include "depth/pair/scratch_buffers.hpp"

namespace pd {
class WarmCertificate;
}

namespace pd::detail {

/// The cores of two posed shapes, both polytopes.
struct PolytopePair {
  const ConvexPolytope* a;
  const ConvexPolytope* b;
  const Pose* pose_a;
  const Pose* pose_b;
  Margins margins;
};

/// The answer by expansion (automatic, expansion) or overlay.
void polytope_depth(const PolytopePair& pair, const DepthSettings& settings, ScratchBuffers& buffers,
                    WarmCertificate* warm, PenetrationDepth& out);

}  // namespace pd::detail
