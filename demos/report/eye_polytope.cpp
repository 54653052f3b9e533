#include "report/eye_polytope.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

namespace pd::report {

namespace {

constexpr int kMostVertices = 400;
constexpr std::int64_t kMostFacets = 2000;
constexpr std::size_t kMostPairs = 64;
constexpr double kCosineOfFeature = 0.985;

/// The corners of an icosahedron whose edges were halved three times, on the unit sphere.
const std::vector<Vec3>& directions() {
  static const std::vector<Vec3> result = [] {
    const double golden = (1 + std::sqrt(5.0)) / 2;
    std::vector<Vec3> points;
    for (int axis = 0; axis < 3; ++axis) {
      for (const double u : {-1.0, 1.0}) {
        for (const double v : {-golden, golden}) {
          Vec3 p;
          p[axis] = 0;
          p[(axis + 1) % 3] = u;
          p[(axis + 2) % 3] = v;
          points.push_back(p.normalized());
        }
      }
    }
    for (int round = 0; round < 3; ++round) {
      const ConvexPolytope hull = ConvexPolytope::from_points(points).value();
      for (int h = 0; h < hull.num_half_edges(); ++h) {
        const Vec3 from = hull.vertex(hull.half_edge(h).origin);
        const Vec3 to = hull.vertex(hull.target(h));
        if (hull.half_edge(h).origin < hull.target(h)) points.push_back((from + to).normalized());
      }
    }
    return points;
  }();
  return result;
}

struct SupportPoint {
  Vec3 direction;  ///< unit, in the core's frame

  Vec3 operator()(const ConvexPolytope& polytope) const {
    int best = 0;
    for (int v = 1; v < polytope.num_vertices(); ++v) {
      if (polytope.vertex(v).dot(direction) > polytope.vertex(best).dot(direction)) best = v;
    }
    return polytope.vertex(best);
  }
  Vec3 operator()(const Ellipsoid& ellipsoid) const {
    const Vec3 scaled = ellipsoid.radii.cwiseProduct(direction);
    return ellipsoid.radii.cwiseProduct(scaled.stableNormalized());
  }
  Vec3 operator()(const Cylinder& cylinder) const {
    Vec3 point = rim(cylinder.axis, cylinder.radius);
    point[cylinder.axis] = std::copysign(cylinder.half_height, direction[cylinder.axis]);
    return point;
  }
  Vec3 operator()(const Cone& cone) const {
    Vec3 base = rim(cone.axis, cone.radius);
    base[cone.axis] = -cone.half_height;
    Vec3 apex = Vec3::Zero();
    apex[cone.axis] = cone.half_height;
    return apex.dot(direction) > base.dot(direction) ? apex : base;
  }
  Vec3 operator()(const SphereHull& hull) const { return hull.support(direction); }

 private:
  [[nodiscard]] Vec3 rim(int axis, double radius) const {
    Vec3 across = direction;
    across[axis] = 0;
    return radius * across.stableNormalized();
  }
};

/// Edges of polygons whose normals differ, each once.
void add_feature_edges(EyePolytope& body) {
  std::map<std::pair<std::int32_t, std::int32_t>, std::size_t> left;
  for (std::size_t f = 0; f < body.polygons.size(); ++f) {
    const auto& loop = body.polygons[f];
    for (std::size_t i = 0; i < loop.size(); ++i) left[{loop[i], loop[(i + 1) % loop.size()]}] = f;
  }
  for (const auto& [edge, f] : left) {
    const auto right = left.find({edge.second, edge.first});
    const bool alone = right == left.end();
    if (!alone && edge.first > edge.second) continue;
    if (alone || body.normals[f].dot(body.normals[right->second]) < kCosineOfFeature) {
      body.edges.push_back({edge.first, edge.second});
    }
  }
}

EyePolytope from_polytope(const ConvexPolytope& polytope, const Pose& pose) {
  EyePolytope result;
  for (int v = 0; v < polytope.num_vertices(); ++v) {
    result.points.emplace_back(pose.rotation() * polytope.vertex(v) + pose.translation());
  }
  for (int f = 0; f < polytope.num_facets(); ++f) {
    const auto loop = polytope.facet_vertices(f);
    result.polygons.emplace_back(loop.begin(), loop.end());
    result.normals.emplace_back(pose.rotation() * polytope.facet_normal(f));
  }
  if (polytope.affine_dimension() == 1) result.edges.push_back({0, 1});
  add_feature_edges(result);
  return result;
}

/// A ring of corners about an axis.
void add_ring(int axis, double radius, double height, std::vector<Vec3>& points) {
  constexpr int kCorners = 48;
  for (int i = 0; i < kCorners; ++i) {
    const double angle = 2 * 3.14159265358979 * i / kCorners;
    Vec3 p;
    p[axis] = height;
    p[(axis + 1) % 3] = radius * std::cos(angle);
    p[(axis + 2) % 3] = radius * std::sin(angle);
    points.push_back(p);
  }
}

EyePolytope from_supports(const ConvexShape& shape, const Pose& pose) {
  std::vector<Vec3> points;
  if (const auto* cylinder = std::get_if<Cylinder>(&shape.core()); cylinder != nullptr && shape.margin() == 0) {
    add_ring(cylinder->axis, cylinder->radius, cylinder->half_height, points);
    add_ring(cylinder->axis, cylinder->radius, -cylinder->half_height, points);
    return from_polytope(ConvexPolytope::from_points(points).value(), pose);
  }
  if (const auto* cone = std::get_if<Cone>(&shape.core()); cone != nullptr && shape.margin() == 0) {
    add_ring(cone->axis, cone->radius, -cone->half_height, points);
    points.emplace_back(cone->half_height * Vec3::Unit(cone->axis));
    return from_polytope(ConvexPolytope::from_points(points).value(), pose);
  }
  for (const Vec3& direction : directions()) {
    points.emplace_back(std::visit(SupportPoint{direction}, shape.core()) + shape.margin() * direction);
  }
  return from_polytope(ConvexPolytope::from_points(points).value(), pose);
}

int kind_of(const MinkowskiDifference::Facet& facet) {
  switch (facet.kind) {
    case DifferenceFacetKind::facet_vertex:
    case DifferenceFacetKind::facet_edge:
      return 0;
    case DifferenceFacetKind::vertex_facet:
    case DifferenceFacetKind::edge_facet:
    case DifferenceFacetKind::facet_facet:
      return 1;
    case DifferenceFacetKind::edge_edge:
      break;
  }
  return 2;
}

EyePolytope from_difference(const MinkowskiDifference& p) {
  EyePolytope result;
  for (const auto& vertex : p.vertices) result.points.push_back(vertex.position);
  for (const auto& facet : p.facets) {
    result.polygons.emplace_back(p.corners.begin() + facet.first, p.corners.begin() + facet.first + facet.count);
    result.normals.push_back(facet.normal);
    result.kinds.push_back(kind_of(facet));
  }
  add_feature_edges(result);
  return result;
}

/// Extreme points of B + (-A) in the directions alone, where P has too many facets to draw.
std::optional<EyePolytope> coarse_difference(const ConvexPolytope& a, const ConvexPolytope& b) {
  std::vector<Vec3> points;
  for (const Vec3& direction : directions()) {
    points.emplace_back(SupportPoint{direction}(b)-SupportPoint{Vec3(-direction)}(a));
  }
  const auto hull = ConvexPolytope::from_points(points);
  if (!hull) return std::nullopt;
  return from_polytope(*hull, Pose());
}

}  // namespace

std::vector<EyePolytope> eye_polytopes(const Compound& body, const Pose& pose) {
  std::vector<EyePolytope> result;
  const auto parts = body.posed(pose);
  if (!parts) return result;
  for (const PosedShape& part : *parts) {
    const ConvexPolytope* polytope = part.shape->polytope();
    const bool plain = polytope != nullptr && part.shape->margin() == 0 && polytope->num_vertices() <= kMostVertices;
    result.push_back(plain ? from_polytope(*polytope, part.pose) : from_supports(*part.shape, part.pose));
  }
  return result;
}

std::vector<EyePolytope> eye_difference(const std::vector<EyePolytope>& a, const std::vector<EyePolytope>& b) {
  std::vector<EyePolytope> result;
  for (const EyePolytope& part_a : a) {
    for (const EyePolytope& part_b : b) {
      if (result.size() == kMostPairs) return result;
      const auto hull_a = ConvexPolytope::from_points(part_a.points);
      const auto hull_b = ConvexPolytope::from_points(part_b.points);
      if (!hull_a || !hull_b) continue;
      const auto p = minkowski_difference(*hull_a, Pose(), *hull_b, Pose(), kMostFacets);
      if (p) {
        result.push_back(from_difference(*p));
      } else if (auto coarse = coarse_difference(*hull_a, *hull_b)) {
        result.push_back(std::move(*coarse));
      }
    }
  }
  return result;
}

}  // namespace pd::report
