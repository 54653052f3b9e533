/// @file
/// Minkowski sums and other compositions as small polytopes ([M] Theorem 2 and section 1.4).
///
/// Outer: K is in K', and h_{K'}(v) <= h_K(v) + (epsilon / 2) width_K(v) for all v, so K' is in K_epsilon. Inner: K' is
/// in K, every directional width of K' at least 1 - epsilon times that of K. As points or as halfspaces, by choice.
///
/// [M] samples the boundary at the points nearest to a net (Dudley's halfspaces; Bronshteyn and Ivanov's points), each
/// found by a search for the least ball that meets K. Departure: a polytope grows inside K in the frame of its
/// fattening ([M] Lemma 10), the facet with the farthest support first. It ends when the support over every facet is
/// certified to be within 1 + epsilon / 2 of its plane. Points and halfspaces are O(1 / epsilon^((d-1)/2)) as measured
/// (`pdepth-bench arya`), the sampling's order, and fewer where K is flat.
///
/// Intersections inside become bodies of halfspaces first, between the supports of polytopes inside their parts and
/// those that hold them, as fine as the intersection asks for (`src/dimension/composed/flattened_body.hpp`). The
/// promise is that of all sums, relative to the widths of the composed body itself. Thin intersections of large parts
/// are dear.
#pragma once

#include "pd/dimension/approximate_body.hpp"
#include "pd/dimension/composed_body.hpp"

namespace pd::dimension {

template <int D>
struct ApproximateSum {
  ApproximateBody<D> body;
  double epsilon = 0;              ///< what `body` keeps; more than asked for where !bracket_reached
  bool bracket_reached = true;     ///< false: the budget of operations ended first
  std::int64_t support_calls = 0;  ///< of K
  std::int64_t vertices = 0;       ///< of the inner polytope
  std::int64_t facets = 0;         ///< of it, coplanar ones once
  QueryCounters counters;
};

/// Budget: a million facets, where a thousand products of the structures count as one, so some four seconds and 0.6 GB
/// in R^5. If it ends first, `body` keeps the larger `epsilon` that was certified so far, and a sum with an
/// intersection inside is refused as limit_exceeded.
///
/// @param sum      `ComposedBody::sum_of`, `hull_of`, `intersection_of`, affine images and their compositions
/// @param epsilon  in [1e-6, 1), at least 4 times that of every structure inside; with hulls inside 8 (1 + r) times,
/// r the ratio of the composed sandwich. With intersections inside it is at least 1e-5 and at least 20 times, and more
/// the thinner they are beside their parts.
/// @return ErrorCode::bad_value ("epsilon"; "" where an intersection is empty); not_full_dimensional for one that has
/// no interior, or none that doubles tell; limit_exceeded for one too thin beside its parts; out_of_range for bodies
/// too slender for doubles.
template <int D>
[[nodiscard]] Expected<ApproximateSum<D>> approximate_minkowski_sum(const ComposedBody<D>& sum, double epsilon,
                                                                    Representation representation,
                                                                    Side side = Side::outer);

}  // namespace pd::dimension
