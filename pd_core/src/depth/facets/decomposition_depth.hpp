/// @file
/// The depth engine after [A] section 2 (algorithm Penetration-Depth): facet-vertex facets by point location in the
/// other normal diagram (step 1), edge-edge facets as closest pairs of lines (step 2), without meeting them all.
///
/// The paper looks at every facet and edge. Here a bound on the depth that is known already (from a search by support
/// functions) and the vertices of P found on the way leave out most: for x in P and a facet's normal n, <x, n> / |n| is
/// a lower bound of its plane's distance; and along an arc shorter than half a circle <x, n> is a piece of a sine,
/// which stays above a positive level where both ends do, so that one x shows a whole arc to be too far.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "depth/distance/gjk_exact.hpp"
#include "depth/facets/closest_lines.hpp"
#include "depth/facets/overlay_depth.hpp"
#include "depth/facets/shared_facets.hpp"

namespace pd::detail {

struct DecompositionBuffers {
  struct TestPoint {
    Vec3 x;
    std::int32_t a;
    std::int32_t b;
  };
  std::vector<VertexPair> vertices;  ///< for the caller's list
  std::vector<TestPoint> test_points;
  std::vector<std::int32_t> far_from_a;  ///< by facet: a test point that shows it too far, or -1
  std::vector<std::int32_t> far_from_b;
  std::vector<std::int32_t> edges_a;  ///< that no test point shows too far, as half-edges
  std::vector<std::int32_t> edges_b;
  SharedFacets shared;
  ClosestLinesBuffers lines;
};

struct DecompositionSettings {
  double upper = std::numeric_limits<double>::infinity();  ///< a bound on the depth, in the pair's scaled lengths
  std::span<const VertexPair> vertices;                    ///< of P, found so far
  std::uint64_t seed = 0;                                  ///< of the random order; no answer depends on it
  bool exactly = true;                                     ///< as for `overlay_depth`
  bool may_enumerate = false;  ///< whether all facets may be looked at where they are too few for anything better
};

struct DecompositionDepth {
  OverlayDepth nearest;  ///< never separated
  ClosestLinesCounts lines;
  std::int64_t edges_a = 0;  ///< edges that took part in the search for the closest lines
  std::int64_t edges_b = 0;
  bool enumerated = false;  ///< the answer is that of `overlay_depth`
};

/// Nearest facet, equal to that of `overlay_depth`. Requires that the origin lies in P (boundary included), as [A]
/// does.
DecompositionDepth decomposition_depth(const PosedPair& pair, const DecompositionSettings& settings,
                                       OverlayDepthBuffers& overlay, DecompositionBuffers& buffers);

}  // namespace pd::detail
