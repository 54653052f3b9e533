/// @file
/// How deep two convex polygons stick in each other ([D] section 3). P stays, Q moves (the paper's convention).
///
/// Let Q be displaced by y. The depth along d, sigma_d, is the least t >= 0 for which Q displaced by y + t d / |d| has
/// no interior point in common with P. The depth, sigma, is the minimum of sigma_d over all directions. Both are about
/// R = P + (-Q): where the ray from y along d leaves it ([D] equation (1)), and how far y is from its boundary
/// (equation (2)).
#pragma once

#include <cstdint>

#include "pd/numeric/expected.hpp"
#include "pd/planar/convex_polygon.hpp"

namespace pd {

/// An edge of R: made of an edge of P, of -Q, or of both where they are parallel; -1 for what has no part in it. The
/// vertices are those that the edge of the other polygon slides on.
struct DifferenceEdge {
  std::int32_t edge_of_p = -1;  ///< from this vertex of P to the next
  std::int32_t edge_of_q = -1;
  std::int32_t vertex_p = -1;  ///< the edge of R begins at vertex_p - vertex_q
  std::int32_t vertex_q = -1;
};

struct PlanarDepth {
  PlanarContact contact = PlanarContact::separated;
  double depth = 0;
  double lower = 0;  ///< lower <= exact <= upper: equal, or neighbouring doubles
  double upper = 0;
  Point2 normal{1, 0};      ///< outward unit normal of R's edge there (overlapping only)
  DifferenceEdge edge;      ///< the same (overlapping only)
  std::int64_t probes = 0;  ///< edges and vertices looked at
};

/// sigma_d without building R: the edge of R that the ray leaves through is searched for in both polygons at once. Take
/// the medians of the two edge sequences that face along d. The one that comes first in slope order loses the half
/// before it, or the other one the half behind it ([D] section 3, after Chazelle and Dobkin). Exact.
/// @param direction  any finite length but zero.
/// @return ErrorCode::non_finite or out_of_range ("displacement", "direction"), zero_direction ("direction").
/// Time O(log n + log m); allocates nothing.
[[nodiscard]] Expected<PlanarDepth> convex_directional_depth(const ConvexPolygon& p, const ConvexPolygon& q,
                                                             const Point2& displacement, const Point2& direction);

/// The times at which Q, displaced by y + t d / |d| for t from -infinity to infinity, meets P. Depth and separation
/// along a direction are the two ends of one interval ([D] section 1).
struct PlanarCrossing {
  bool meets = false;  ///< exact; touching counts
  /// Neighbouring doubles around the exact values, or equal; of either sign.
  double enter_lower = 0, enter_upper = 0;
  double leave_lower = 0, leave_upper = 0;
  std::int64_t probes = 0;
};
/// Errors and time as `convex_directional_depth`.
[[nodiscard]] Expected<PlanarCrossing> convex_crossing(const ConvexPolygon& p, const ConvexPolygon& q,
                                                       const Point2& displacement, const Point2& direction);

/// Tells if the polygons meet ([D] Lemma 2.1): y inside R, on its boundary, or outside, exact. Time O(log n + log m).
[[nodiscard]] Expected<PlanarContact> convex_intersection(const ConvexPolygon& p, const ConvexPolygon& q,
                                                          const Point2& displacement);

/// sigma by all edges of R, exact; of equally near edges the first. Time O(n + m). For many placements:
/// medial_axis.hpp.
/// @return as `convex_directional_depth`, but for the direction.
[[nodiscard]] Expected<PlanarDepth> convex_depth(const ConvexPolygon& p, const ConvexPolygon& q,
                                                 const Point2& displacement);

}  // namespace pd
