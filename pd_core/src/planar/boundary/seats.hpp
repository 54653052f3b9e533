/// @file
/// Places of zero area in R = P + (-Q), at which Q fits exactly: slots and single points. The closure of R surrounds
/// them, and yet the interiors of P and Q do not meet there.
#pragma once

#include <vector>

#include "planar/boundary/arc_cover.hpp"
#include "planar/boundary/boundary_query.hpp"

namespace pd::detail {

/// The places of a candidate where covered parts end and others begin, or where it ends itself, that lie inside no
/// covered part and on no part of the boundary. Every single seat is one, on each candidate through it.
[[nodiscard]] std::vector<Position> seat_places_of(const SumBoundary& boundary, const Candidate& candidate,
                                                   const CandidateCover& cover);

/// The single seats of a boundary that was made with seats, rounded, in lexicographic order.
[[nodiscard]] std::vector<Point2> single_seats(const BoundaryQuery& query);
/// The slots, rounded, each once and as long as it is, from its lesser end on.
[[nodiscard]] std::vector<std::array<Point2, 2>> whole_slots(const SumBoundary& boundary);

}  // namespace pd::detail
