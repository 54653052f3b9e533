/// @file
/// The face of a curved P that is nearest to the origin, from inside.
#pragma once

#include <cstdint>
#include <vector>

#include "depth/difference/smooth_difference.hpp"
#include "depth/expansion/expanding_polytope.hpp"
#include "depth/pair/scratch_buffers.hpp"
#include "pd/depth/depth_answer.hpp"

namespace pd::detail {

/// Supports of one expansion; each takes about a microsecond. Directions tied along a circle, as of a ball in the
/// middle of a cone, take some thousand at a delta of 1e-6.
inline constexpr int kMaxSmoothSteps = 16384;

struct SmoothFace {
  ExpansionResult found;
  DifferenceVertex corners[3];  ///< of the face, if there is one
  bool foot_known = false;      ///< `weights` are those of the origin's foot
  double weights[3] = {};
  const std::vector<DifferenceVertex>* searched = nullptr;  ///< all points that its search met, in `buffers`
};

enum class FacePurpose : std::uint8_t {
  contact,  ///< within the budget of contacts (contact_budget.hpp), with the bracket that it leaves
  bracket,
  foot  ///< the origin's foot on the face as well, by the local minimum next to the face
};

/// By an expanding polytope in doubles; where rounding folds its surface, from another start, and at last by an exact
/// hull of the points.
///
/// @param goal  how near; the steps and losses that it allows are set here
SmoothFace nearest_smooth_face(const PosedShape& a, const PosedShape& b, const SmoothDifference& difference,
                               ExpansionGoal goal, FacePurpose purpose, ScratchBuffers& buffers,
                               Statistics& statistics);

}  // namespace pd::detail
