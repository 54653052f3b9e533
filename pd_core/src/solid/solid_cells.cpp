#include "solid/solid_cells.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "solid/winding.hpp"

namespace pd::detail {

namespace {

int exponent_of(const MeshSolid& solid) {
  const TriangleNode& root = solid.nodes().front();
  const double size = std::max(root.low.cwiseAbs().maxCoeff(), root.high.cwiseAbs().maxCoeff());
  return size > 0 ? std::ilogb(size) : 0;
}

Vec3 middle_of(const ConvexCell& cell) {
  Vec3 sum = Vec3::Zero();
  double count = 0;
  for (const PlanePolygon& facet : cell.facets()) {
    for (const Vec3& corner : facet.corners) sum += corner;
    count += static_cast<double>(facet.corners.size());
  }
  return sum / count;
}

/// True if a point in doubles lies inside of a cell, off its walls.
bool lies_inside(const PlaneSet& planes, const ConvexCell& cell, const Vec3& x) {
  return std::all_of(cell.facets().begin(), cell.facets().end(),
                     [&](const PlanePolygon& facet) { return planes.sign_at_point(facet.plane, x) < 0; });
}

}  // namespace

SolidCells::SolidCells(const MeshSolid& solid)
    : solid_(solid), alone_(solid, identity_, solid, identity_), exponent_(exponent_of(solid)), planes_(exponent_) {}

SolidCell SolidCells::whole() {
  SolidCell all{ConvexCell::cube(planes_, std::ldexp(1.0, exponent_ + 2)), {}, {}};
  for (const MeshSolid::Triangle& t : solid_.triangles()) all.faces.push_back(polygon_of(t));
  return all;
}

PlanePolygon SolidCells::polygon_of(const MeshSolid::Triangle& t) {
  std::array<Dyadic3, 3> corners;
  for (std::size_t k = 0; k < 3; ++k) corners[k] = to_dyadic(solid_.vertex(t.vertices[k]));
  const Dyadic3 normal = cross(corners[1] - corners[0], corners[2] - corners[0]);
  PlanePolygon polygon;
  polygon.plane = planes_.add(normal, dot(normal, corners[0]));
  int axis = 0;
  planes_.normal(polygon.plane).cwiseAbs().maxCoeff(&axis);
  const double up = planes_.normal(polygon.plane)[axis] > 0 ? 1 : -1;
  // Edges lie in planes along the axis, whose coefficients are short.
  for (std::size_t k = 0; k < 3; ++k) {
    const Dyadic3 along = corners[(k + 1) % 3] - corners[k];
    const Vec3 unit = up * Vec3::Unit(axis);
    const Dyadic3 outwards = cross(along, to_dyadic(unit));
    polygon.sides.push_back(planes_.add(outwards, dot(outwards, corners[k])));
  }
  polygon.update(planes_);
  ++polygons_;
  return polygon;
}

SolidCells::Halves SolidCells::split(SolidCell here, Side plane) {
  std::optional<ConvexCell> inner_cell = here.cell.inside(planes_, plane);
  std::optional<ConvexCell> outer_cell = here.cell.inside(planes_, plane.opposite());
  SolidCell inner, outer;
  const auto share = [&](std::vector<PlanePolygon>& from, std::vector<PlanePolygon> SolidCell::*list) {
    for (PlanePolygon& polygon : from) {
      if (polygon.plane.plane() == plane.plane()) {
        inner.on_walls.push_back(polygon);
        outer.on_walls.push_back(std::move(polygon));
        continue;
      }
      PlanePolygon below, above;
      switch (cut(planes_, polygon, plane, below, &above)) {
        case Cut::inside:
          (inner.*list).push_back(std::move(polygon));
          break;
        case Cut::outside:
          (outer.*list).push_back(std::move(polygon));
          break;
        case Cut::split:
          ++polygons_;
          (inner.*list).push_back(std::move(below));
          (outer.*list).push_back(std::move(above));
          break;
      }
    }
  };
  share(here.faces, &SolidCell::faces);
  share(here.on_walls, &SolidCell::on_walls);
  Halves halves;
  if (inner_cell) {
    inner.cell = *std::move(inner_cell);
    halves.inside = std::move(inner);
  }
  if (outer_cell) {
    outer.cell = *std::move(outer_cell);
    halves.beyond = std::move(outer);
  }
  return halves;
}

std::optional<bool> SolidCells::is_solid(const SolidCell& here) const {
  // A face on one of the walls tells: it shows its back to the solid.
  for (const PlanePolygon& face : here.on_walls) {
    for (const PlanePolygon& wall : here.cell.facets()) {
      if (wall.plane.plane() == face.plane.plane()) return wall.plane == face.plane;
    }
  }
  return middle_is_solid(here.cell);
}

PosedPoint SolidCells::posed(const Vec3& x) const {
  PosedPoint point;
  point.x = x * std::ldexp(1.0, exponent_ - alone_.scale_exponent());
  point.exact = true;
  return point;
}

std::optional<bool> SolidCells::middle_is_solid(const ConvexCell& cell) const {
  const Vec3 middle = middle_of(cell);
  if (!lies_inside(planes_, cell, middle)) return std::nullopt;
  return place_in(alone_, Body::b, posed(middle)).winding > 0;
}

bool SolidCells::holds(const Vec3& x) const {
  const PointPlace place = place_in(alone_, Body::b, posed(x));
  return place.on_surface || place.winding > 0;
}

bool SolidCells::may_be_solid_at(const SolidCell& here, const Vec3& corner) const {
  // Within this distance of the corner no face lies in the cell, so that the cell is all solid or all empty there.
  double clear = HUGE_VAL;
  for (const PlanePolygon& face : here.faces) {
    double apart = std::abs(planes_.height(face.plane, corner));
    for (const Side side : face.sides) apart = std::max(apart, planes_.height(side, corner));
    clear = std::min(clear, apart);
  }
  // A corner of a piece of a face, or next to one: within rounding of the solid.
  constexpr double kNear = 0x1p-42;
  if (clear <= kNear) return true;
  const Vec3 inwards = middle_of(here.cell) - corner;
  const Vec3 inner = corner + std::min(1.0, 0.5 * clear / inwards.norm()) * inwards;
  return !lies_inside(planes_, here.cell, inner) || holds(inner);
}

}  // namespace pd::detail
