/// @file
/// The nearest edge-edge facet of P: the closest pair of lines over all pairs of edges whose arcs cross ([A] Lemma 2.2
/// and Theorem 2.4), by a dual tree.
///
/// The paper decomposes the pairs into complete bipartite graphs of vertically separated lines and finds each one's
/// closest pair by Agarwal and Sharir's randomised algorithm, whose emptiness tests rest on cuttings in four
/// parameters: nothing that can be built. What is kept is its frame, a minimum that falls as blocks of lines come in
/// random order, each asked only whether it holds a pair closer than the least distance r so far. The test is replaced
/// by bounds on pairs of nodes of two trees, and the decomposition by the same descent: a pair of nodes is dropped when
/// no arc of one can meet one of the other, when they meet in one known facet only (shared_facets.hpp), or when no two
/// of their lines can be as close as r; the rest is split, and what is left at the leaves is tried pair by pair,
/// exactly.
///
/// The bound. N = |d x d'| dist is bilinear in the two lines (line_tree.hpp). As sqrt(1 - t^2) is concave, dist >= r
/// holds over a block where s N + (r t0 / D0) t - r (D0 + t0^2 / D0) >= 0 for one sign s, with t = <d, d'> and D0 =
/// sqrt(1 - t0^2): still one bilinear form <u_i, M u'_j>. With centres c, c' and residuals e_i, e'_j = b_j v' + w'_j
/// (v' the chord) it is
///   <c, M c'> + <e_i, M c'> + <c, M e'_j> + b_j <e_i, M v'> + <e_i, M w'_j>.
/// The last term is of third order in the size of the block. The others are minimised over i and j together: phi(g) =
/// min_j (<c, M e'_j> + g b_j) is concave in g = <e_i, M v'>, hence above its chord over the range of g, which two
/// passes over the lines of one node and one over those of the other evaluate.
///
/// There is no bound on the work like Theorem 2.4's: measured m^1.2 on smooth profiles, where the paper has m^(3/2),
/// but m^2 on profiles whose edges are turned at random by more than the angle between neighbours.
#pragma once

#include <cstdint>
#include <vector>

#include "depth/facets/facet_enumeration.hpp"
#include "depth/facets/line_tree.hpp"

namespace pd::detail {

struct ClosestLinesBuffers {
  LineTree a;
  LineTree b;
  struct Block {
    std::int32_t b;
    std::int32_t a;
  };
  std::vector<Block> stack;
  std::vector<double> values;
  std::vector<double> slopes;
};

struct ClosestLinesCounts {
  std::int64_t pair_evaluations = 0;  ///< pairs of lines whose distance was taken
  std::int64_t block_bounds = 0;      ///< pairs of nodes that were bounded
  std::int64_t lines_scanned = 0;     ///< lines passed over for bounds
};

/// Offers to `search` every edge-edge facet that may be as near as `search.upper()`, which falls on the way. The trees
/// hold the lines in lengths divided by `unit`, all points of P within 1 of the origin then.
/// Requires that the origin lies in P (boundary included), and that the facets that the trees were told of are offered
/// or certainly farther.
/// @param seed  of the order in which blocks are tried; the answer does not depend on it.
void offer_closest_lines(const OverlayWalk& walk, double unit, std::uint64_t seed, ClosestLinesBuffers& buffers,
                         PlaneSearch& search, ClosestLinesCounts& counts);

}  // namespace pd::detail
