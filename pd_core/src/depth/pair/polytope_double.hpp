/// @file
/// The stages of a query that answer in doubles with error bounds. Each returns whether it has answered; where not,
/// what it wrote to `out` besides the statistics is overwritten by the stage that does.
#pragma once

#include <span>

#include "depth/distance/gjk.hpp"
#include "depth/expansion/expanding_polytope.hpp"
#include "depth/pair/polytope_query.hpp"

namespace pd::detail {

/// Width of the bracket that doubles are asked for, as the goal of an expansion.
[[nodiscard]] ExpansionGoal expansion_goal(const PolytopeQuery& query);

/// Answers for bodies that a support towards P's centre shows apart, by the closest points at once.
bool answer_few_apart(PolytopeQuery& query, PenetrationDepth& out);

/// Answers from all facets of P by the bodies' Gauss maps (facets/gauss_sat.hpp). For the tightest bracket the nearest
/// one is proved.
bool answer_by_gauss_maps(PolytopeQuery& query, PenetrationDepth& out);

/// Grows a polytope inside P, from the pair's warm certificate where it serves, and saves what the next call may start
/// from. The faces are left in the scratch (`buffers.surface`).
[[nodiscard]] ExpansionResult grow_surface(PolytopeQuery& query, PenetrationDepth& out);

/// Whether a bracket of the surface in the scratch is as narrow as the caller asked, whatever ended its search.
[[nodiscard]] bool narrow_enough(const PolytopeQuery& query, const ExpansionResult& found);

/// Answers by the surface's nearest face, whose bracket ended the search.
bool answer_from_surface(PolytopeQuery& query, PenetrationDepth& out);

/// Witnesses and features of a face of the surface, or of those in its plane where the origin projects.
void set_contact_of_face(const PolytopeQuery& query, int face, const Vec3& unit_normal, PenetrationDepth& out);

/// Witnesses and features of the closest points of the cores; `out.normal` is set.
void set_contact_of_simplex(const PolytopePair& pair, const ClosestPoint& nearest, PenetrationDepth& out);

/// Returns the bounds of a surface that stopped early, the upper one lowered by supports along the normals of its
/// nearest faces.
[[nodiscard]] ExpansionResult bounded(PolytopeQuery& query, ExpansionResult surface, Statistics& statistics);

/// Answers if many facets are nearly as near: among those alone, else in the way of [A].
bool answer_among_many_facets(PolytopeQuery& query, PenetrationDepth& out);

/// What is left after the margins may be far smaller than the cores' distance: no relative error of that would do.
[[nodiscard]] double relative_of_distance(const PolytopeQuery& query);

/// The point of P closest to the origin, from vertices of P that may be near it.
[[nodiscard]] ClosestPoint closest_point(PolytopeQuery& query, std::span<const DifferenceVertex> start,
                                         Statistics& statistics);

/// Cores that are apart: separated, or overlapping by their margins, or for `Bracket::contact` touching. The simplex is
/// saved in the warm certificate.
bool answer_apart(PolytopeQuery& query, const ClosestPoint& nearest, PenetrationDepth& out);

}  // namespace pd::detail
