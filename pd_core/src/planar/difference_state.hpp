/// @file
/// What a PolygonDifference keeps.
#pragma once

#include <memory>
#include <optional>

#include "planar/boundary/boundary_query.hpp"
#include "planar/disc_bracket.hpp"

namespace pd {

/// Where only Q is non-convex the implicit method takes the two in each other's place: Q + (-P) is -R.
struct PolygonDifference::State {
  State(const Polygon& p_in, const Polygon& q_in, bool implicit_in, bool swapped_in, std::int64_t max_comparisons)
      : p(p_in),
        q(q_in),
        implicit(implicit_in),
        swapped(swapped_in),
        boundary(p, q, implicit, max_comparisons),
        query(boundary) {}

  Polygon p, q;
  bool implicit, swapped;
  std::optional<detail::BoundaryCounts> given_up;  ///< of an implicit boundary that contradicted Facts 4.1 or 4.2
  detail::SumBoundary boundary;
  detail::BoundaryQuery query;

  /// The polygons around R swept by a disc, made by the first question that needs them and kept for the same radius.
  /// Read and written by `std::atomic_load` and `std::atomic_store`: Clang's library has no atomic of a shared pointer.
  mutable std::shared_ptr<const detail::DiscBracket> disc;

  [[nodiscard]] Point2 turned(const Point2& v) const { return swapped ? Point2{-v[0], -v[1]} : v; }
  /// Fills the answer with the way from y (turned) to the nearest point of the boundary, or of its outer curve alone.
  void move_to_nearest(const Point2& y, bool outer_only, PolygonDepth& answer) const;
};

}  // namespace pd
