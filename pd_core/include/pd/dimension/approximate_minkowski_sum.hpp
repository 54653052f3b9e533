/// @file
/// Minkowski sums, and other compositions without intersections, as small polytopes ([M] Theorem 2).
///
/// Outer: K is in K', and h_{K'}(v) <= h_K(v) + (epsilon / 2) width_K(v) for all v, so K' is in K_epsilon. Inner: K' is
/// in K, every directional width of K' at least 1 - epsilon times that of K. As points or as halfspaces, by choice.
///
/// [M] samples the boundary at the points nearest to a net (Dudley's halfspaces; Bronshteyn and Ivanov's points), each
/// found by a search for the least ball that meets K. Departure: a polytope grows inside K in the frame of its
/// fattening ([M] Lemma 10), the facet with the farthest support first, until the support over every facet is certified
/// to be within 1 + epsilon / 2 of its plane. Points and halfspaces are O(1 / epsilon^((d-1)/2)) as measured
/// (`pdepth-bench arya`), the sampling's order, and fewer where K is flat.
#pragma once

#include "pd/dimension/approximate_body.hpp"
#include "pd/dimension/composed_body.hpp"

namespace pd::dimension {

template <int D>
struct ApproximateSum {
  ApproximateBody<D> body;
  std::int64_t support_calls = 0;  ///< of K
  std::int64_t vertices = 0;       ///< of the inner polytope
  std::int64_t facets = 0;         ///< of it, coplanar ones once
  QueryCounters counters;
};

/// @param sum      `ComposedBody::sum_of`, `hull_of`, affine images and their compositions
/// @param epsilon  in [1e-6, 1), at least 4 times that of every structure inside; with hulls inside 8 (1 + r) times, r
/// the ratio of the composed sandwich.
/// @return ErrorCode::bad_value ("epsilon"); unsupported for an intersection inside, which has no support without a
/// search; out_of_range for bodies too slender for doubles.
template <int D>
[[nodiscard]] Expected<ApproximateSum<D>> approximate_minkowski_sum(const ComposedBody<D>& sum, double epsilon,
                                                                    Representation representation,
                                                                    Side side = Side::outer);

}  // namespace pd::dimension
