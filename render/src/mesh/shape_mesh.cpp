#include <Eigen/Geometry>
#include <cassert>
#include <cmath>
#include <numbers>

#include "mesh/mesh_builder.hpp"

namespace pd::render {
namespace {

MeshRef core_mesh(const ConvexShape& shape) {
  struct Maker {
    MeshRef operator()(const ConvexPolytope& polytope) const { return polytope_mesh(polytope); }
    MeshRef operator()(const Ellipsoid& body) const { return ellipsoid_mesh(body.radii); }
    MeshRef operator()(const Cylinder& body) const { return cylinder_mesh(body.radius, body.half_height, body.axis); }
    MeshRef operator()(const Cone& body) const { return cone_mesh(body.radius, body.half_height, body.axis); }
    MeshRef operator()(const SphereHull& body) const { return sphere_hull_mesh(body); }
  };
  return std::visit(Maker{}, shape.core());
}

std::vector<Vec3> sphere_directions() {
  constexpr int kDirectionsAround = 48;
  constexpr int kDirectionRows = 24;
  std::vector<Vec3> directions = {-Vec3::UnitZ(), Vec3::UnitZ()};
  for (int row = 1; row < kDirectionRows; ++row) {
    const double angle = std::numbers::pi * (static_cast<double>(row) / kDirectionRows - 0.5);
    for (int step = 0; step < kDirectionsAround; ++step) {
      const double turn = 2 * std::numbers::pi * step / kDirectionsAround;
      directions.emplace_back(std::cos(angle) * std::cos(turn), std::cos(angle) * std::sin(turn), std::sin(angle));
    }
  }
  return directions;
}

/// The hull of the core's points, each moved out by the margin along the directions in which it is extreme: facets keep
/// their flat images, edges and vertices become round. Shading normals are those directions.
MeshRef swept_mesh(std::span<const Vec3> core, std::span<const Vec3> directions, double margin) {
  double reach = margin;
  for (const Vec3& point : core) {
    reach = std::max(reach, point.cwiseAbs().maxCoeff());
  }
  std::vector<Vec3> points;
  std::vector<Vec3> normals;
  for (const Vec3& direction : directions) {
    double support = -1e308;
    for (const Vec3& point : core) {
      support = std::max(support, direction.dot(point));
    }
    for (const Vec3& point : core) {
      // Ties (an edge's or a facet's own direction) belong to all their points; a picture needs no better than this.
      if (direction.dot(point) >= support - 1e-9 * reach) {
        points.push_back(point + margin * direction);
        normals.push_back(direction);
      }
    }
  }
  const auto hull = ConvexPolytope::from_points(points);
  assert(hull);  // the points are finite and in range, because the shape's are
  detail::MeshBuilder builder;
  for (int facet = 0; facet < hull->num_facets(); ++facet) {
    std::uint32_t first = 0;
    std::uint32_t last = 0;
    int corner = 0;
    for (const std::int32_t v : hull->facet_vertices(facet)) {
      const Vec3& normal = normals[static_cast<std::size_t>(hull->caller_id(v))];
      const std::uint32_t vertex = builder.add_vertex(hull->vertex(v), normal);
      if (corner == 0) {
        first = vertex;
      } else if (corner >= 2) {
        builder.add_triangle(first, last, vertex);
      }
      last = vertex;
      ++corner;
    }
  }
  return builder.finish();
}

}  // namespace

MeshRef shape_mesh(const ConvexShape& shape) {
  if (shape.margin() == 0) {
    return core_mesh(shape);
  }
  std::vector<Vec3> core;
  std::vector<Vec3> directions = sphere_directions();
  if (const ConvexPolytope* polytope = shape.polytope()) {
    for (int v = 0; v < polytope->num_vertices(); ++v) {
      core.push_back(polytope->vertex(v));
    }
    for (int facet = 0; facet < polytope->num_facets(); ++facet) {
      directions.push_back(polytope->facet_normal(facet));
    }
  } else {
    const MeshRef mesh = core_mesh(shape);
    for (const Mesh::Vertex& vertex : mesh->vertices) {
      core.push_back(mesh->unit * Vec3(vertex.position[0], vertex.position[1], vertex.position[2]));
      directions.emplace_back(vertex.normal[0], vertex.normal[1], vertex.normal[2]);
    }
  }
  return swept_mesh(core, directions, shape.margin());
}

}  // namespace pd::render
