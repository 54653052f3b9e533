/// @file
/// Depth of two solids of at most eight vertices from the facets of P that were near the origin in an earlier frame, in
/// doubles with a certificate: a few planes and one support, no search.
///
/// Why it proves anything: as in expansion/cached_surface.hpp, the closed surface being P's own boundary as it was
/// then, moved by its vertices. Its faces stay flat, since facets are turned as they are and parallelograms stay such.
/// No vertex of P has moved by more than m (the way of one pair of vertices, and how much more any other vertex of
/// either body has moved).
/// 1. If m is less than every plane's distance from an inner point q, the surface winds round q as it did.
/// 2. Facets then farther than d + m are farther than d still, and have not met the segment from the origin to q.
/// 3. The planes of the others are computed anew; where they have the origin and q behind them, they miss that segment,
///    too, so the surface winds round the ball that no face reaches.
/// So P holds that ball. A support along the nearest plane's normal shows that P ends there.
#pragma once

#include "depth/difference/bracket_width.hpp"
#include "depth/difference/polytope_difference.hpp"
#include "depth/expansion/cached_surface.hpp"
#include "depth/facets/gauss_sat.hpp"
#include "depth/facets/near_facets.hpp"
#include "pd/shape/pose.hpp"

namespace pd::detail {

/// How much farther than the bodies' nearest facet is remembered. Both have a Gauss map.
[[nodiscard]] double remembered_band(const PolytopeDifference& difference);

/// What is remembered of a certified answer: of `near`, which may be put in another order, those that are nearest.
/// False where there is nothing: `near` is not complete, or the bodies' poses are no rotations.
bool remember_pieces(const GaussSatDepth& found, NearGaussPieces& near, const PolytopeDifference& difference,
                     WarmPieces& out);

/// `certified` false where the bodies have moved too far. Requires `then` to be of the difference's bodies,
/// supports prepared and a reach between 2^-100 and 2^100. Constant time, no allocation.
/// @param looked_at  planes computed.
[[nodiscard]] NearFacets certify_remembered_pieces(const WarmPieces& then, const Pose& pose_a, const Pose& pose_b,
                                                   const PolytopeDifference& difference, const BracketWidth& width,
                                                   int& looked_at);

}  // namespace pd::detail
