/// @file
/// From an exact place on the boundary of R to the answer that leaves: bracket, translation, normal, feature.
#pragma once

#include <optional>

#include "planar/boundary/boundary_query.hpp"

namespace pd::detail {

/// The vector (x / w, y / w), w != 0.
struct ExactVector {
  Dyadic x, y, w;
};
[[nodiscard]] ExactVector difference(const Homogeneous<Dyadic>& x, const Point2& y);

/// Q moved by v. `turned`: P and Q stand in each other's place, so that v is turned round.
void fill(PolygonDepth& answer, const ExactVector& v, bool turned);
/// Q where it touches P along that edge of the boundary: the edge's outer normal.
void fill_touching(PolygonDepth& answer, const Span& edge, bool turned);
/// Q moved along the ray as far as a place on that edge. `direction`: the caller's, not turned.
void fill_hit(PolygonDepth& answer, const Span& ray, const Point2& direction, const Span& edge, const Place& at,
              bool turned);

/// What of P and Q meets at a point of the boundary.
[[nodiscard]] std::optional<PlanarFeature> feature_of(const SumBoundary& boundary, const Polygon& p, const Polygon& q,
                                                      const BoundaryPoint& x, bool swapped);

}  // namespace pd::detail
