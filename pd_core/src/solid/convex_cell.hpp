/// @file
/// A bounded convex cell of space, cut by planes exactly.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "compound/plane_polygon.hpp"

namespace pd::detail {

class ConvexCell {
 public:
  /// The cube of all |coordinate| <= half.
  static ConvexCell cube(PlaneSet& planes, double half);

  /// The part inside of a plane; nothing where it has no interior. Adds the section as a facet.
  [[nodiscard]] std::optional<ConvexCell> inside(const PlaneSet& planes, Side side) const;

  [[nodiscard]] const std::vector<PlanePolygon>& facets() const { return facets_; }

 private:
  /// The polygon that the cell's planes leave of another plane.
  [[nodiscard]] std::optional<PlanePolygon> section(const PlaneSet& planes, Side side) const;

  std::array<std::array<Side, 2>, 3> walls_;  ///< of the cube: along each axis the negative and the positive one
  std::vector<PlanePolygon> facets_;          ///< their planes look outwards
};

}  // namespace pd::detail
