/// @file
/// Polytopes of extreme sizes, answered at size 1 where a power of two brings them there without rounding.
#pragma once

#include "depth/pair/polytope_query.hpp"

namespace pd::detail {

/// Depths obey the law of powers of two, so that a pair of size 1e-300 has the answer of one of size 1, where doubles
/// have room for squares and products of lengths. Nothing of the certificate is used or learnt: what it holds are
/// lengths of the pair as given.
/// @return false, with `out` as it was, where a coordinate or a margin would be rounded (it is subnormal on one side)
/// or a length of an answer that is exact, and where the search is watched: observers see lengths of the pair.
/// Contacts' brackets are rounded outwards. Two copies of the bodies, O(n), and a query within
/// `PolytopeQuery::within_range`.
bool answer_at_size_one(const PolytopeQuery& query, PenetrationDepth& out);

}  // namespace pd::detail
