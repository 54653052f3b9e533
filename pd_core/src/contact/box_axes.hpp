/// @file
/// The axis along which two boxes are least deep, or farthest apart: that of depth/facets/box_sat_kernels.hpp, less the
/// heights that an axis is known not to see. The normal u x v of two edges is across both, so that four half edges of
/// six are summed over.
///
/// Compiled for several instruction sets; every lane on its own: the same bits on each.
#pragma once

#include "depth/facets/box_pair.hpp"
#include "pd/contact/box_contact.hpp"

namespace pd::detail {

/// As `BoxPair::distance` says it, errors included.
/// @param centre  of B, from that of A
/// @param reach   at least the distance of any two of the boxes' points
/// @param exact_edges  all numbers of the axes are of single precision: their products are exact, so that even edges
/// turned by 1e-7 span a plane known to 2u
[[nodiscard]] BoxDistance distance_of_boxes(const BoxInRows& a, const BoxInRows& b, const double (&centre)[3],
                                            double reach, bool exact_edges);

}  // namespace pd::detail
