/// @file
/// The width of a body, the least of its directional widths, within 1 + epsilon ([M] Theorem 3).
///
/// The width is the distance from the origin to the boundary of K + (-K). [M] takes Dudley's halfspaces of an
/// epsilon-approximation of K + (-K) and returns the one nearest to the origin. Departure: the halfspaces are those of
/// the facets of a polytope that grows inside K + (-K), the facet nearest to the origin first, each queried by its
/// normal. It ends as soon as the least width met and the nearest facet agree. Most directions are therefore never
/// refined where the body is not equally wide everywhere. On a ball it grows to O(1 / epsilon^((d-1)/2)) vertices,
/// Dudley's number.
#pragma once

#include "pd/dimension/composed_body.hpp"
#include "pd/dimension/directional_width.hpp"

namespace pd::dimension {

template <int D>
struct ApproximateWidth {
  double width = 0;             ///< = upper
  double lower = 0;             ///< of the exact width, certified by points of the body
  double upper = 0;             ///< the width of the whole body along `direction`; upper <= (1 + epsilon) lower
  Vector<D> direction;          ///< of length 1
  bool bracket_reached = true;  ///< false: a budget of operations ended first; upper may exceed (1 + epsilon) lower
  std::int64_t facets = 0;      ///< of the growing polytope, in all
  std::int64_t vertices = 0;    ///< of it
  QueryCounters queries;
  StructureSize structure;
};

/// @param epsilon  in (0, 1); at least 1.2e-7 with the kernel backend. Both ends are widened by 1e-10 for rounding, so
/// that below 1e-5 they may stand (1 + epsilon) (1 + 3e-10) apart.
/// @return ErrorCode::bad_value ("epsilon").
/// The structure of the backend is built for 0.9 epsilon / (1 + epsilon), the search ends at the rest. Budget of the
/// search: a million facets, where a thousand products of the structure count as one; if it ends first, the bracket so
/// far stands.
template <int D>
[[nodiscard]] Expected<ApproximateWidth<D>> approximate_width(const Body<D>& body, double epsilon,
                                                              Backend backend = Backend::kernel);

/// The width of a body composed of others (sums, hulls of unions, intersections, affine images). Measured is a small
/// polytope inside, which every directional width exceeds by a known factor at most. `structure` and `queries` are
/// those of that polytope. Budgets as above and those of `approximate_minkowski_sum`.
///
/// @param epsilon  in [2e-6, 1), with an intersection inside [2e-5, 1); the structures inside at least as fine as
/// `approximate_minkowski_sum` asks at 0.7 epsilon / (1 + epsilon).
/// @return those of `approximate_minkowski_sum`.
template <int D>
[[nodiscard]] Expected<ApproximateWidth<D>> approximate_width(const ComposedBody<D>& body, double epsilon);

}  // namespace pd::dimension
