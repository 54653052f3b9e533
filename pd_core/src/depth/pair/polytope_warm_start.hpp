/// @file
/// The warm certificate of a pair of polytopes: what a query may take from it, and what it saves for the next one.
///
/// Whatever the certificate holds is ids; planes and points are computed from the present poses, so that an answer is
/// proved as if there had been no certificate.
#pragma once

#include "depth/distance/gjk.hpp"
#include "depth/expansion/expanding_polytope.hpp"
#include "depth/pair/polytope_query.hpp"

namespace pd::detail {

/// Answers for bodies that were apart in the last frame, from the vertices around their last closest point.
bool answer_from_memory(PolytopeQuery& query, PenetrationDepth& out);

/// Whether a surface has been saved, of whatever pair: the bodies overlapped in the last frame.
[[nodiscard]] bool remembers_overlap(const PolytopeQuery& query);
/// Puts the saved surface at the present poses, into the scratch. False when there is none for this pair.
[[nodiscard]] bool restore_surface(PolytopeQuery& query);
/// Whether the restored surface answers as it stands.
[[nodiscard]] bool certify_restored_surface(PolytopeQuery& query, ExpansionResult& result, Statistics& statistics);
/// Where the depth was expected last, or zero.
[[nodiscard]] Vec3 warm_direction(const PolytopeQuery& query);

/// The surface has grown, or is new.
void save_surface(PolytopeQuery& query, const ExpansionResult& result);
/// The simplex of P that holds its closest point, and the direction from there.
void save_simplex(PolytopeQuery& query, const ClosestPoint& nearest);

}  // namespace pd::detail
