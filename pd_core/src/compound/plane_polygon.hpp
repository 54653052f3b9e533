/// @file
/// Convex polygons that are known by planes alone: the one they lie in and those that bound them. Cut exactly, however
/// often: a corner is always the meeting point of three of the planes that were there from the start, so that numbers
/// do not grow (after Bernstein, Fussell, "Fast, exact, linear booleans", 2009).
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "compound/plane_set.hpp"

namespace pd::detail {

/// {x in plane : inside every side}, with a nonempty relative interior. Sides run counter-clockwise about the plane's
/// outward normal; edge i lies on side i, corner i between sides i and i + 1.
struct PlanePolygon {
  Side plane;
  std::vector<Side> sides;
  std::vector<Vec3> corners;  ///< in doubles, each coordinate within `error` (lengths of the plane set)
  double error = 0;

  /// Computes the corners.
  void update(const PlaneSet& planes);
};

enum class Cut : std::uint8_t {
  inside,   ///< all of the polygon lies in the closed halfspace
  outside,  ///< none of its relative interior lies in the halfspace
  split,
};

/// Cuts a polygon by the halfspace of `side`. Only when `split` are the two parts written; each has a nonempty
/// relative interior. A polygon in the plane itself is `inside`.
/// @param outer  nullptr: not wanted.
[[nodiscard]] Cut cut(const PlaneSet& planes, const PlanePolygon& polygon, Side side, PlanePolygon& inner,
                      PlanePolygon* outer);

/// Returns the part of a polygon inside of every wall; nothing if that part has no relative interior.
[[nodiscard]] std::optional<PlanePolygon> part_inside(const PlaneSet& planes, PlanePolygon polygon,
                                                      std::span<const Side> walls);

/// Whether a point given in doubles lies in the closed polygon, exactly.
[[nodiscard]] bool contains_point(const PlaneSet& planes, const PlanePolygon& polygon, const Vec3& x);
/// The point of the polygon nearest to the origin, in doubles: within a few `error` of a point of the polygon.
[[nodiscard]] Vec3 nearest_point(const PlaneSet& planes, const PlanePolygon& polygon);

/// The same exactly.
struct ExactNearestPoint {
  PlaneSet::ExactPoint point;  ///< denominator > 0
  bool projection;             ///< it is the projection of the origin on the polygon's plane
};
/// Time O(corners) where doubles guess the nearest edge or corner right, squared else; exact arithmetic throughout.
[[nodiscard]] ExactNearestPoint exact_nearest_point(const PlaneSet& planes, const PlanePolygon& polygon);

}  // namespace pd::detail
