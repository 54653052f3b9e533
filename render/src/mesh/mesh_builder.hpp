/// @file
/// Grows a mesh from polygons and edges given in doubles.
#pragma once

#include <span>

#include "pd/render/mesh.hpp"

namespace pd::render::detail {

class MeshBuilder {
 public:
  /// @return index of the new vertex.
  std::uint32_t add_vertex(const Vec3& position, const Vec3& normal, const std::array<float, 4>& tint = {});
  void add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c);
  /// A flat convex polygon, counter-clockwise about its normal.
  void add_polygon(std::span<const Vec3> loop, const Vec3& normal, const std::array<float, 4>& tint = {});
  void add_edge(const Vec3& from, const Vec3& to, const Vec3& normal_left, const Vec3& normal_right);
  [[nodiscard]] MeshRef finish();

 private:
  struct Edge {
    Vec3 from;
    Vec3 to;
  };
  std::shared_ptr<Mesh> mesh_ = std::make_shared<Mesh>();
  // Positions stay in doubles until the unit is known.
  std::vector<Vec3> positions_;
  std::vector<Edge> edges_;
};

}  // namespace pd::render::detail
