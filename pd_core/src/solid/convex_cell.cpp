#include "solid/convex_cell.hpp"

#include <algorithm>
#include <utility>

namespace pd::detail {

namespace {

/// A plane in the cube: what the walls across the two axes leave of it that its normal is farthest from.
PlanePolygon wide_polygon(const PlaneSet& planes, Side plane, const std::array<std::array<Side, 2>, 3>& walls) {
  int axis = 0;
  planes.normal(plane).cwiseAbs().maxCoeff(&axis);
  const auto i = static_cast<std::size_t>((axis + 1) % 3), j = static_cast<std::size_t>((axis + 2) % 3);
  PlanePolygon polygon;
  polygon.plane = plane;
  polygon.sides = {walls[i][1], walls[j][1], walls[i][0], walls[j][0]};
  if (planes.normal(plane)[axis] < 0) std::reverse(polygon.sides.begin(), polygon.sides.end());
  polygon.update(planes);
  return polygon;
}

}  // namespace

ConvexCell ConvexCell::cube(PlaneSet& planes, double half) {
  ConvexCell cell;
  for (int axis = 0; axis < 3; ++axis) {
    for (const int sign : {-1, 1}) {
      Dyadic3 normal;
      (axis == 0 ? normal.x : axis == 1 ? normal.y : normal.z) = Dyadic(static_cast<double>(sign));
      cell.walls_[static_cast<std::size_t>(axis)][sign < 0 ? 0 : 1] = planes.add(normal, Dyadic(half));
    }
  }
  for (const auto& pair : cell.walls_) {
    for (const Side wall : pair) cell.facets_.push_back(wide_polygon(planes, wall, cell.walls_));
  }
  return cell;
}

std::optional<PlanePolygon> ConvexCell::section(const PlaneSet& planes, Side side) const {
  std::vector<Side> around;
  for (const PlanePolygon& facet : facets_) around.push_back(facet.plane);
  return part_inside(planes, wide_polygon(planes, side, walls_), around);
}

std::optional<ConvexCell> ConvexCell::inside(const PlaneSet& planes, Side side) const {
  ConvexCell part;
  part.walls_ = walls_;
  bool cuts = false, any_inside = false;
  for (const PlanePolygon& facet : facets_) {
    if (facet.plane.plane() == side.plane()) {
      if (!(facet.plane == side)) return std::nullopt;
      return *this;
    }
    PlanePolygon inner;
    switch (cut(planes, facet, side, inner, nullptr)) {
      case Cut::outside:
        cuts = true;
        break;
      case Cut::inside:
        any_inside = true;
        part.facets_.push_back(facet);
        break;
      case Cut::split:
        cuts = any_inside = true;
        part.facets_.push_back(std::move(inner));
        break;
    }
  }
  if (!any_inside) return std::nullopt;
  if (!cuts) return part;
  std::optional<PlanePolygon> middle = section(planes, side);
  if (!middle) return part;
  part.facets_.push_back(*std::move(middle));
  return part;
}

}  // namespace pd::detail
