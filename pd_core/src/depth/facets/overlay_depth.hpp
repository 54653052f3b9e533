/// @file
/// The depth engine that looks at every facet of P = B + (-A): the least distance from the origin to the plane of a
/// facet, over the overlay of the two normal diagrams ([A] section 2, steps 1 and 2, with every edge-edge facet
/// enumerated).
///
/// pi(A, B) is attained at the plane of a facet when the origin lies inside P; the origin lies outside P exactly when
/// it lies strictly outside the plane of some facet. Planes are bounded in doubles; `FacetSelection` decides
/// between those that tie.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "depth/facets/facet_selection.hpp"
#include "pd/depth/depth_answer.hpp"
#include "structure/overlay/face_sum.hpp"
#include "structure/overlay/facet_of_difference.hpp"
#include "structure/overlay/overlay_walk.hpp"

namespace pd::detail {

/// Grown on first use.
struct OverlayDepthBuffers {
  OverlayBuffers overlay;
  std::vector<DifferencePoint> loop;
  FacetCandidates candidates;
};

struct OverlayDepth {
  ContactClass contact = ContactClass::separated;  ///< exact
  /// False where there is no such facet: P is a segment or a point, or it is flat and the origin lies outside.
  bool has_facet = false;
  /// Overlapping: a facet with the nearest plane; of several at exactly the same distance the first by (kind: facet of
  /// A, facet of B, edges; ids of A; ids of B). Touching: the same, through the origin. Separated: a facet of P that
  /// the origin lies strictly outside of, the first that was met.
  FacetOfDifference facet;
  /// Pieces of the overlay whose plane was evaluated.
  std::int64_t facets_visited = 0;
  /// Distances compared as fractions (beside the exact signs that the pair counts itself).
  std::int64_t exact_comparisons = 0;
};

/// Exact class and nearest facet. Time O(m + n + K deg), see `OverlayWalk`; allocates nothing once the buffers have
/// grown, except in exact arithmetic.
///
/// @param exactly  whether facets that double-double cannot distinguish are compared as fractions (some 1e-30 of the
/// depth lies
///                 between them otherwise).
/// @param upper    a bound on the depth that is known already, in the pair's scaled lengths.
OverlayDepth overlay_depth(const PosedPair& pair, OverlayDepthBuffers& buffers, bool exactly = true,
                           double upper = std::numeric_limits<double>::infinity());

}  // namespace pd::detail
