#include "solid/sharp_edges.hpp"

#include <algorithm>
#include <cmath>

#include "solid/posed_solids.hpp"

namespace pd::detail {

namespace {

/// Reflex edges that are looked at, and edges for each of them.
constexpr std::size_t kMostReflex = 4, kMostPartners = 3;
/// Edges whose faces turn by less than some 45 degrees belong to smooth surfaces: planes through them cut slivers off.
constexpr double kSmooth = 0.7;
/// Points nearer to a plane than this lie in it, in lengths of the planes.
constexpr double kInPlane = 0x1p-36;

/// True if a part of the segment with a length lies in the cell, and not in one of its walls.
bool runs_in(const ConvexCell& cell, const PlaneSet& planes, const Vec3& p, const Vec3& q, bool walls_too) {
  double from = 0, to = 1;
  for (const PlanePolygon& wall : cell.facets()) {
    const double a = planes.height(wall.plane, p), b = planes.height(wall.plane, q);
    if (a >= kInPlane && b >= kInPlane) return false;
    if (!walls_too && a >= -kInPlane && b >= -kInPlane) return false;
    if (a > kInPlane) from = std::max(from, a / (a - b));
    if (b > kInPlane) to = std::min(to, a / (a - b));
  }
  return from < to;
}

}  // namespace

SharpEdges::SharpEdges(const MeshSolid& solid, int exponent) : solid_(solid) {
  const Pose identity;
  const PosedSolids alone(solid, identity, solid, identity);
  const double scale = std::ldexp(1.0, -exponent);
  const auto unit_normal = [&](const MeshSolid::Triangle& t) -> Vec3 {
    const Vec3 &p = solid.vertex(t.vertices[0]), &q = solid.vertex(t.vertices[1]), &r = solid.vertex(t.vertices[2]);
    return ((q - p) * scale).cross((r - p) * scale).stableNormalized();
  };
  for (std::size_t t = 0; t < solid.triangles().size(); ++t) {
    const MeshSolid::Triangle& here = solid.triangles()[t];
    for (std::size_t k = 0; k < 3; ++k) {
      const std::int32_t p = here.vertices[k], q = here.vertices[(k + 1) % 3];
      if (p > q) continue;  // the other triangle has it
      const MeshSolid::Triangle& there = solid.triangle(here.neighbours[k]);
      const auto apex =
          std::find_if(there.vertices.begin(), there.vertices.end(), [&](std::int32_t v) { return v != p && v != q; });
      const int rise =
          alone.orient3d(alone.corners(Body::a, static_cast<std::int32_t>(t)), alone.point(Body::a, *apex));
      const Vec3 normals[2] = {unit_normal(here), unit_normal(there)};
      if (rise == 0 || normals[0].dot(normals[1]) > kSmooth) continue;
      edges_.push_back({{p, q}, solid.vertex(p) * scale, solid.vertex(q) * scale, rise > 0, {normals[0], normals[1]}});
    }
  }
}

void SharpEdges::keep(std::vector<Ranked>& list, std::size_t most, const Ranked& found) {
  if (list.size() == most && !(found < list.back())) return;
  list.insert(std::upper_bound(list.begin(), list.end(), found), found);
  if (list.size() > most) list.pop_back();
}

Side SharpEdges::plane_through(const Edge& edge, std::int32_t vertex, PlaneSet& planes) const {
  const auto point = [&](std::int32_t v) { return to_dyadic(solid_.vertex(v)); };
  const Dyadic3 origin = point(edge.vertices[0]);
  const Dyadic3 normal = cross(point(edge.vertices[1]) - origin, point(vertex) - origin);
  return planes.add(normal, dot(normal, origin));
}

std::vector<Side> SharpEdges::planes_in(const ConvexCell& cell, PlaneSet& planes, const Vec3& near) const {
  std::vector<Ranked> reflex;
  for (const Edge& edge : edges_) {
    if (!edge.reflex) continue;
    const double distance = (0.5 * (edge.p + edge.q) - near).norm();
    if (reflex.size() == kMostReflex && distance >= reflex.back().distance) continue;
    if (runs_in(cell, planes, edge.p, edge.q, false)) keep(reflex, kMostReflex, {distance, &edge});
  }
  std::vector<Side> sides;
  for (const Ranked& ranked : reflex) {
    const Edge& edge = *ranked.edge;
    const Vec3 along = (edge.q - edge.p).normalized();
    std::vector<Ranked> partners;
    for (const Edge& other : edges_) {
      const Vec3 u = other.p - edge.p, v = other.q - edge.p;
      const auto is_behind = [&](const Vec3& way) {
        return edge.normals[0].dot(way) <= kInPlane && edge.normals[1].dot(way) <= kInPlane;
      };
      if (!is_behind(u) || !is_behind(v) || std::abs(along.dot(u.cross(v))) > kInPlane) continue;
      const double distance = along.cross(0.5 * (u + v)).norm();
      if (distance <= kInPlane || (partners.size() == kMostPartners && distance >= partners.back().distance)) continue;
      if (runs_in(cell, planes, other.p, other.q, true)) keep(partners, kMostPartners, {distance, &other});
    }
    for (const Ranked& partner : partners) {
      const Edge& other = *partner.edge;
      const bool first = along.cross(other.p - edge.p).norm() > along.cross(other.q - edge.p).norm();
      const Side side = plane_through(edge, other.vertices[first ? 0 : 1], planes);
      const bool is_new =
          std::none_of(sides.begin(), sides.end(), [&](const Side& known) { return known.plane() == side.plane(); });
      if (is_new) sides.push_back(side);
    }
  }
  return sides;
}

}  // namespace pd::detail
