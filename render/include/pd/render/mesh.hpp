/// @file
/// Surfaces to draw. Tessellation of curved bodies happens here, for the eye only; no query ever sees it.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "pd/numeric/vector.hpp"
#include "pd/render/palette.hpp"
#include "pd/shape/convex_polytope.hpp"
#include "pd/shape/convex_shape.hpp"
#include "pd/shape/pose.hpp"

namespace pd::render {

/// Axis-aligned; empty while lower > upper.
struct Box {
  Vec3 lower = Vec3::Constant(1e300);
  Vec3 upper = Vec3::Constant(-1e300);
  void include(const Vec3& p) {
    lower = lower.cwiseMin(p);
    upper = upper.cwiseMax(p);
  }
  void include(const Box& other) {
    lower = lower.cwiseMin(other.lower);
    upper = upper.cwiseMax(other.upper);
  }
  [[nodiscard]] bool empty() const { return (lower.array() > upper.array()).any(); }
  [[nodiscard]] Vec3 centre() const { return 0.5 * (lower + upper); }
  [[nodiscard]] double diagonal() const { return (upper - lower).norm(); }
};

/// Triangles (counter-clockwise from outside) with shading normals, and feature edges to ink. Positions are local and
/// in units of `unit`, so that single precision serves bodies of any size. Immutable once shared: the renderer keeps a
/// copy on its device for as long as the mesh lives.
struct Mesh {
  struct Vertex {
    std::array<float, 3> position;
    std::array<float, 3> normal;
    std::array<float, 4> tint;  ///< colour and 1, or zeros: the body's colour
  };
  /// A line to ink between two surfaces; it is drawn faintly where both face away. A boundary has opposite normals.
  struct Edge {
    std::array<float, 3> from;
    std::array<float, 3> to;
    std::array<float, 3> normal_left;
    std::array<float, 3> normal_right;
  };
  double unit = 1;  ///< largest |coordinate|, in the unit of the input
  std::vector<Vertex> vertices;
  std::vector<std::uint32_t> triangles;  ///< three indices each
  std::vector<Edge> feature_edges;
  Box bounds;  ///< in the unit of the input
};
using MeshRef = std::shared_ptr<const Mesh>;

/// Facets fanned into flat triangles; edges between facets that meet at more than 10 degrees are feature edges. A
/// polygon in space is drawn from both sides, a segment as its edge alone.
/// @param facet_colours  empty, or one colour for each facet.
[[nodiscard]] MeshRef polytope_mesh(const ConvexPolytope& polytope, std::span<const Colour> facet_colours = {});

/// Any triangle surface, counter-clockwise from outside: flat where neighbours meet at more than `crease_degrees`,
/// smooth elsewhere. Feature edges are the creases and the boundary.
[[nodiscard]] MeshRef triangle_mesh(std::span<const Vec3> points,
                                    std::span<const std::array<std::int32_t, 3>> triangles, double crease_degrees = 10);

[[nodiscard]] MeshRef box_mesh(const Vec3& half_extents);
[[nodiscard]] MeshRef sphere_mesh(double radius);
[[nodiscard]] MeshRef ellipsoid_mesh(const Vec3& radii);
/// Axis 0, 1, 2 = x, y, z; the segment runs from -half_height to +half_height.
[[nodiscard]] MeshRef capsule_mesh(double radius, double half_height, int axis);
[[nodiscard]] MeshRef cylinder_mesh(double radius, double half_height, int axis);
/// Base at -half_height, apex at +half_height.
[[nodiscard]] MeshRef cone_mesh(double radius, double half_height, int axis);
[[nodiscard]] MeshRef sphere_hull_mesh(const SphereHull& hull);

/// Any body of the library: its core, swept by its margin.
[[nodiscard]] MeshRef shape_mesh(const ConvexShape& shape);

/// Bounds of a posed mesh.
[[nodiscard]] Box posed_bounds(const Mesh& mesh, const Pose& pose);

}  // namespace pd::render
