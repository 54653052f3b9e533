#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "mesh/mesh_builder.hpp"

namespace pd::render {
namespace {

using Triangle = std::array<std::int32_t, 3>;

/// Interior angle at corner k: the weight that makes a vertex normal independent of how its facets are cut.
double corner_angle(std::span<const Vec3> points, const Triangle& triangle, std::size_t k) {
  const Vec3& at = points[static_cast<std::size_t>(triangle[k])];
  const Vec3 u = points[static_cast<std::size_t>(triangle[(k + 1) % 3])] - at;
  const Vec3 v = points[static_cast<std::size_t>(triangle[(k + 2) % 3])] - at;
  return std::atan2(u.cross(v).norm(), u.dot(v));
}

}  // namespace

MeshRef triangle_mesh(std::span<const Vec3> points, std::span<const Triangle> triangles, double crease_degrees) {
  const double crease_cosine = std::cos(crease_degrees * std::numbers::pi / 180);
  std::vector<Vec3> normals;
  std::vector<std::vector<std::size_t>> around(points.size());
  std::map<std::pair<std::int32_t, std::int32_t>, std::vector<std::size_t>> edges;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const auto point = [&](std::size_t k) -> const Vec3& { return points[static_cast<std::size_t>(triangles[t][k])]; };
    const Vec3 cross = (point(1) - point(0)).cross(point(2) - point(0));
    normals.push_back(cross.norm() > 0 ? cross.normalized() : Vec3(Vec3::Zero()));
    for (std::size_t k = 0; k < 3; ++k) {
      around[static_cast<std::size_t>(triangles[t][k])].push_back(t);
      edges[std::minmax(triangles[t][k], triangles[t][(k + 1) % 3])].push_back(t);
    }
  }

  detail::MeshBuilder builder;
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    std::array<std::uint32_t, 3> corner{};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto point = static_cast<std::size_t>(triangles[t][k]);
      Vec3 normal = Vec3::Zero();
      for (const std::size_t other : around[point]) {
        if (normals[other].dot(normals[t]) >= crease_cosine || other == t) {
          const auto place = std::find(triangles[other].begin(), triangles[other].end(), triangles[t][k]);
          const auto at = static_cast<std::size_t>(place - triangles[other].begin());
          normal += corner_angle(points, triangles[other], at) * normals[other];
        }
      }
      corner[k] = builder.add_vertex(points[point], normal.norm() > 0 ? normal.normalized() : normals[t]);
    }
    builder.add_triangle(corner[0], corner[1], corner[2]);
  }
  for (const auto& [ends, sides] : edges) {
    const Vec3& left = normals[sides[0]];
    const Vec3 right = sides.size() == 2 ? normals[sides[1]] : Vec3(-left);
    if (left.dot(right) < crease_cosine) {
      builder.add_edge(points[static_cast<std::size_t>(ends.first)], points[static_cast<std::size_t>(ends.second)],
                       left, right);
    }
  }
  return builder.finish();
}

Box posed_bounds(const Mesh& mesh, const Pose& pose) {
  Box box;
  if (mesh.bounds.empty()) {
    return box;
  }
  // The image of a box in a box: centre maps to centre, half extents through |R|.
  const Vec3 half = 0.5 * (mesh.bounds.upper - mesh.bounds.lower);
  const Vec3 centre = pose.rotation() * mesh.bounds.centre() + pose.translation();
  const Vec3 reach = pose.rotation().cwiseAbs() * half;
  box.include(centre - reach);
  box.include(centre + reach);
  return box;
}

}  // namespace pd::render
