/// @file
/// The stages of a query that answer on the stored numbers: proofs in double-double of what doubles have found, and
/// exact engines where those fail. Each returns whether it has answered.
#pragma once

#include <limits>

#include "depth/expansion/expanding_polytope.hpp"
#include "depth/facets/gauss_sat.hpp"
#include "depth/pair/polytope_query.hpp"

namespace pd::detail {

/// All facets of P by the overlay of the two normal diagrams. Always answers.
/// @param upper  a bound on the depth of the cores.
bool answer_by_overlay(PolytopeQuery& query, PenetrationDepth& out,
                       double upper = std::numeric_limits<double>::infinity());

/// [A] section 2, below the bound that the expansion leaves and with the vertices of P that it found. Always answers.
bool answer_by_decomposition(PolytopeQuery& query, const ExpansionResult& surface, PenetrationDepth& out);

/// The surface's nearest face proved to lie in the nearest facet of P, mostly without big numbers.
bool prove_surface(PolytopeQuery& query, PenetrationDepth& out);

/// Of the few pieces of P's boundary that may be nearest (`buffers.near_facets.nearest`), the one that is. Those pieces
/// and what lies beyond cover the boundary, as the triangles of a surface enclose a ball: the proof is the same.
/// @param beyond  no other piece is nearer to the origin; 0: not known.
bool prove_near_facets(PolytopeQuery& query, double beyond, PenetrationDepth& out);

/// Proves the nearest facet that the Gauss maps tell, or the nearest of several that they leave (facets/gauss_sat.hpp),
/// also if the planes differ by rounding only.
bool prove_gauss_maps(PolytopeQuery& query, const GaussSatDepth& found, NearGaussPieces& near, PenetrationDepth& out);

/// Exact expansion from the surface's nearest face, the origin inside the surface for certain.
bool answer_by_exact_expansion(PolytopeQuery& query, PenetrationDepth& out);

/// The class by the point of P closest to the origin: in doubles where they suffice, else exactly from the simplex in
/// which they ended; bodies that meet go on to the exact expansion. Always answers.
bool answer_by_closest_point(PolytopeQuery& query, PenetrationDepth& out);

}  // namespace pd::detail
