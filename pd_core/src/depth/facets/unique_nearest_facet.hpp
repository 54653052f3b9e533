/// @file
/// The nearest facet of P where doubles cannot find it, without big numbers where no other facet is exactly as near.
///
/// An expansion like the exact one (exact_expanding_polytope.hpp) on the same exact hull. Faces are measured in doubles
/// while they are far from the answer, in double-double where they may be nearest; a support is any vertex of P that
/// lies strictly beyond the face, exactly. Bodies turned against each other by noise have hundreds of facets that
/// differ by 1e-16 of their distance, which the bounds of the exact expansion, two doubles, do not tell apart: it ranks
/// them all by fractions. Sizes beyond the range of doubles' products are no other than any: the pair is scaled.
#pragma once

#include <optional>
#include <span>

#include "depth/certificate/nearest_facet_proof.hpp"

namespace pd::detail {

struct UniqueNearestFacet {
  /// As `facet_of_direction` gives it; nothing where the origin does not lie in the interior of P, where other facets
  /// are as near as double-double can tell, or where the budget ran out: an exact search must.
  std::optional<ProvenFacet> found;
  /// Else the corners of the face that the search ended with, if it came to one: next to the closest point of P where
  /// that holds the origin not, or hardly.
  std::optional<SurfaceCorners> ended;
  std::int64_t support_calls = 0;
  std::int64_t facets_visited = 0;
};

/// @param start   vertices of P to begin with.
/// @param budget  supports allowed.
/// @param faces   filled with the faces in the facet's plane.
[[nodiscard, gnu::cold]] UniqueNearestFacet unique_nearest_facet(const PosedPair& pair,
                                                                 std::span<const VertexPair> start, int budget,
                                                                 SupportFaces& faces);

}  // namespace pd::detail
