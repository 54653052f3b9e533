/// @file
/// The hull of points that planes define, as a polytope of doubles that lies in the hull or holds the hull for certain.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "pd/shape/convex_polytope.hpp"
#include "solid/convex_cell.hpp"

namespace pd::detail {

/// Three planes of positive determinant: they meet in a corner.
using PlaneMeet = std::array<Side, 3>;

/// The corners of a part: exact ones once, in doubles; and the planes that meet there.
class PartCorners {
 public:
  /// @param scale  Lengths outside = lengths of the planes * scale, a power of two.
  PartCorners(PlaneSet& planes, double scale) : planes_(planes), scale_(scale) {}
  PartCorners(PlaneSet& planes, const ConvexCell& cell, double scale);

  void add(const PlaneMeet& meet);
  /// Adds every corner of a polygon.
  void add(const PlanePolygon& polygon);

  /// Every corner is a double.
  [[nodiscard]] bool exact() const { return exact_; }
  /// The hull of the rounded corners; nothing where it is flat.
  [[nodiscard]] std::optional<ConvexPolytope> polytope() const { return hull(points_); }

  /// A polytope that lies in a cell; nothing for cells thinner than what rounding moves.
  [[nodiscard]] std::optional<ConvexPolytope> inner(const ConvexCell& cell) const;

  /// A polytope that holds the corners, and at most how far it reaches beyond their hull.
  struct Outer {
    ConvexPolytope polytope;
    double reach = 0;
  };
  /// Requires a corner.
  [[nodiscard]] Outer outer() const;

 private:
  [[nodiscard]] Vec3 centre() const;
  [[nodiscard]] std::vector<Vec3> moved(double share) const;
  [[nodiscard]] std::optional<ConvexPolytope> hull(std::vector<Vec3> points) const;
  /// True if the polytope holds every corner, or every one that is no double: the others are among its points.
  [[nodiscard]] bool holds(const ConvexPolytope& polytope, bool doubles_too) const;

  PlaneSet& planes_;
  double scale_;
  std::vector<Vec3> points_;      ///< lengths of the planes
  std::vector<PlaneMeet> meets_;  ///< the planes of each point
  std::vector<char> is_double_;   ///< the point is the meet itself
  bool exact_ = true;
};

}  // namespace pd::detail
