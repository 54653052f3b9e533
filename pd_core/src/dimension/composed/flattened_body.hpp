/// @file
/// Composed bodies without their intersections: each of these becomes a body of halfspaces ([M] section 1.4).
///
/// An intersection has no support without a search, but its parts do. A polytope grows inside each part until every
/// facet's support is certified ([M] Theorem 2); with the same normals and two offsets, I'' of all the facets' planes
/// lies in the intersection I, and I' of the certified supports holds it. About a point c inside I'', with s'' and s'
/// the offsets less those of c, I' is in c + lambda (I'' - c), lambda the largest s' / s''. While lambda - 1 exceeds
/// what is allowed, the parts are grown finer: a thin intersection of large parts takes many facets of theirs.
#pragma once

#include "dimension/composed/composed_node.hpp"
#include "pd/dimension/approximate_body.hpp"

namespace pd::dimension::detail {

/// K', a composition without intersections, between K and K with each intersection I replaced by c + (1 + growth) (I -
/// c) for some c in I (outer), or by c + (I - c) / (1 + growth) and K (inner).
/// @param body    requires equations() > 0
/// @param growth  in (0, 1)
/// @param later   growth to which a polytope is to be made inside K'; the structures of K' are fine enough for it, as
/// long as those of K are.
/// @return bad_value where an intersection is empty, or ("epsilon") where the structures inside are too coarse;
/// not_full_dimensional where an intersection is too thin, or empty, for doubles to tell; limit_exceeded where it is so
/// thin beside its parts that they take more than 200,000 vertices.
[[nodiscard]] Expected<Composed> without_intersections(const Composed& body, Side side, double growth, double later);

}  // namespace pd::dimension::detail
