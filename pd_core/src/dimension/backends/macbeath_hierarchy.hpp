/// @file
/// The hierarchy of Macbeath regions of [M] (Lemma 5; Arya, da Fonseca, Mount, "Near-optimal epsilon-kernel
/// construction and related problems", 2017): approximate directional widths by a descent through O(log(1 / epsilon))
/// layers.
///
/// Layer i holds regions centred on the boundary of (1 - delta_i) K*, delta_i falling geometrically to epsilon; those
/// of the leaves are as large as what their points answer (`PolarBody::answering_region`). A region enters when its
/// direction lies in the core shadow of none before it (so that regions shrunk further are disjoint: [M]'s packing);
/// the layer ends when the cells of an adaptive grid of directions each lie in one cover shadow: every direction is
/// covered, for certain. A parent links to the children whose cells meet its shadow. A query goes from region to child,
/// each of them shadowing the direction, and returns the leaf's point.
///
/// Departures from [M]: built on a kernel by scans of it, once, instead of bootstrapping, so the time to build is no
/// 1 / epsilon^((d-1)/2 + alpha); numbers of nodes, degrees and visits are measured (`pdepth-bench arya`).
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "dimension/backends/macbeath_region.hpp"
#include "dimension/backends/width_structure.hpp"

namespace pd::dimension::detail {

/// The build may take so many operations. A shadow held against a box counts as one, a cell walked through does, and so
/// do eight points that a region is cut from. They take some 0.1 microseconds each, and at most 100 MB. If a body and
/// an epsilon need more, as on spheres in R^5, no hierarchy is made.
inline constexpr std::int64_t kMostMacbeathWork = 12'000'000;

/// @param points   of K, extreme or not; K is their hull
/// @param frame    maps C of K's sandwich to the unit ball: O inside, K fat
/// @param epsilon  in (0, 1): supports fall short of h by at most epsilon h, h measured from the frame's O, so by
/// epsilon width_K at most.
/// @param most_work  budget of operations
/// @return null if the budget is spent.
[[nodiscard]] std::unique_ptr<WidthStructure> build_macbeath_hierarchy(const std::vector<AnySupport>& points,
                                                                       const AnyMap& frame, double epsilon,
                                                                       std::int64_t most_work = kMostMacbeathWork);

}  // namespace pd::dimension::detail
