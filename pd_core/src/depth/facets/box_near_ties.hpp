/// @file
/// Which of the facets of two boxes that are nearest to the origin up to rounding is the nearest, on the stored
/// numbers.
///
/// Boxes that lie face on face and are turned as a whole are so: the normals of both faces, and the products of their
/// edges, differ by the rounding of two rotations, and P has a facet along each of them. Every two generators that are
/// not parallel span a facet of P on either side; its corner is told by the exact signs of the other generators along
/// its normal. The one that holds the foot q of the origin in its plane is the nearest of those nearly parallel to it:
/// let d be its distance, n its normal, and m how far q lies inside. Another supporting plane, whose normal is turned
/// from n by an angle t towards a unit vector e of the plane, has q and q + m e behind it, so that it lies no nearer
/// than d cos t + m sin t, which is d or more where tan(t / 2) <= m / d. Facets in other directions are compared in
/// double-double.
#pragma once

#include <optional>

#include "depth/certificate/nearest_facet_proof.hpp"
#include "depth/facets/box_sat.hpp"

namespace pd::detail {

/// @param found  of both boxes; those flagged `parallel` must be so exactly.
/// @param faces  filled with the faces in the facet's plane.
/// @return nothing where two are exactly as near, or double-double does not tell.
[[nodiscard]] std::optional<ProvenFacet> nearest_of_box_facets(const PosedPair& pair, const BoxNearFacets& found,
                                                               SupportFaces& faces);

}  // namespace pd::detail
