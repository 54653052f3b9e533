/// @file
/// Several facets of P may be the nearest to the origin up to rounding. The nearest of them on the stored numbers is
/// found and proved here.
///
/// Bodies that lie face on face and are turned as a whole have many: the normals of both faces, and the products of
/// their edges, differ by the rounding of two rotations, and P has a facet along each of them. The facet that holds the
/// foot q of the origin in its plane is the nearest of those nearly parallel to it: let d be its distance, n its
/// normal, and m how far q lies inside. Another supporting plane, whose normal is turned from n by an angle t towards a
/// unit vector e of the plane, has q and q + m e behind it, so that it lies no nearer than d cos t + m sin t, which is
/// d or more where tan(t / 2) <= m / d. Facets in other directions are compared in double-double.
#pragma once

#include <optional>

#include "depth/certificate/nearest_facet_proof.hpp"
#include "depth/facets/gauss_sat.hpp"

namespace pd::detail {

/// Returns the piece as a facet of P. If it is made of edges, (b[1] - b[0]) x (a[1] - a[0]) points outwards.
[[nodiscard]] FacetOfDifference facet_of(const PosedPair& pair, const NearFacets& piece);

/// Finds the nearest of the listed facets and proves it.
/// @param difference  of the same bodies, supports prepared
/// @param near   has `all_told`, and may hold pieces that are no facets of P.
/// @param faces  filled with the faces in the facet's plane.
/// @return nothing if two facets are exactly as near, or if double-double does not tell.
[[nodiscard]] std::optional<ProvenFacet> nearest_of_ties(const PosedPair& pair, const PolytopeDifference& difference,
                                                         const NearGaussPieces& near, SupportFaces& faces);

}  // namespace pd::detail
