/// @file
/// Two boxes whose edges run along the axes of the frame that they share, exactly: P is such a box, too, and the planes
/// of its six facets are sums of three stored numbers each, which double-double holds as they are.
#pragma once

#include <cstdint>

#include "depth/certificate/nearest_facet_proof.hpp"

namespace pd::detail {

enum class AlignedBoxes : std::uint8_t {
  found,  ///< one facet is the nearest
  tied,   ///< several are, or the origin does not lie inside P
  other   ///< not aligned, or a sum needs more than double-double
};

/// Requires boxes (`box_frame`).
/// @param nearest, faces  the nearest facet and the faces in its plane, where one is.
[[nodiscard]] AlignedBoxes nearest_of_aligned_boxes(const PosedPair& pair, ProvenFacet& nearest, SupportFaces& faces);

}  // namespace pd::detail
