/// @file
/// `Bracket::contact` of two polytopes where the search in doubles came to no answer: the narrowest certified interval
/// that doubles and double-double can give, and never exact numbers.
#pragma once

#include "depth/expansion/expansion_goal.hpp"
#include "depth/pair/polytope_query.hpp"
#include "pd/depth/depth_answer.hpp"

namespace pd::detail {

/// Answers `Bracket::contact` if P lies in a ball that is smaller than the width that may be left open, for example two
/// balls about one centre. Bodies may have any size.
bool answer_at_one_place(PolytopeQuery& query, PenetrationDepth& out);

/// Answers `Bracket::contact`, always.
///
/// The origin surely inside: the surface's bounds. Else the signed distance c of the cores lies in [-h_P(n), |x|] for
/// any unit n and any point x of P: x from GJK in doubles or double-double, n from the search, from GJK, or across what
/// is flat. `bracket_reached` says whether that is as narrow as asked.
/// Time: a bounded number of supports beyond the search.
bool answer_contact(PolytopeQuery& query, PenetrationDepth& out);

}  // namespace pd::detail
