/// @file
/// Whether a facet of P = B + (-A), of a facet of one body and a vertex of the other or of two edges, holds the point
/// below the origin, in doubles.
#pragma once

#include "depth/difference/polytope_difference.hpp"
#include "depth/facets/near_facets.hpp"

namespace pd::detail {

/// @param s      the support along the piece's unit normal, at `height` along it.
/// @param piece  its kind, features and normal; of edges, where on them the point lies is filled in.
/// Requires posed vertices (`PolytopeDifference::prepare_supports`).
[[nodiscard]] bool holds_foot(const PolytopeDifference& difference, const DifferenceVertex& s, double height,
                              NearFacets& piece);

}  // namespace pd::detail
