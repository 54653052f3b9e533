#include "mesh/mesh_builder.hpp"

#include <algorithm>

namespace pd::render::detail {
namespace {

std::array<float, 3> single(const Vec3& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

}  // namespace

std::uint32_t MeshBuilder::add_vertex(const Vec3& position, const Vec3& normal, const std::array<float, 4>& tint) {
  mesh_->bounds.include(position);
  positions_.push_back(position);
  mesh_->vertices.push_back({{}, single(normal), tint});
  return static_cast<std::uint32_t>(mesh_->vertices.size() - 1);
}

void MeshBuilder::add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  mesh_->triangles.insert(mesh_->triangles.end(), {a, b, c});
}

void MeshBuilder::add_polygon(std::span<const Vec3> loop, const Vec3& normal, const std::array<float, 4>& tint) {
  std::uint32_t first = 0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const std::uint32_t vertex = add_vertex(loop[i], normal, tint);
    if (i == 0) {
      first = vertex;
    } else if (i >= 2) {
      add_triangle(first, vertex - 1, vertex);
    }
  }
}

void MeshBuilder::add_edge(const Vec3& from, const Vec3& to, const Vec3& normal_left, const Vec3& normal_right) {
  mesh_->bounds.include(from);
  mesh_->bounds.include(to);
  edges_.push_back({from, to});
  mesh_->feature_edges.push_back({{}, {}, single(normal_left), single(normal_right)});
}

MeshRef MeshBuilder::finish() {
  if (!mesh_->bounds.empty()) {
    const double reach = std::max(mesh_->bounds.lower.cwiseAbs().maxCoeff(), mesh_->bounds.upper.cwiseAbs().maxCoeff());
    mesh_->unit = reach > 0 ? reach : 1;
  }
  for (std::size_t i = 0; i < positions_.size(); ++i) {
    mesh_->vertices[i].position = single(positions_[i] / mesh_->unit);
  }
  for (std::size_t i = 0; i < edges_.size(); ++i) {
    mesh_->feature_edges[i].from = single(edges_[i].from / mesh_->unit);
    mesh_->feature_edges[i].to = single(edges_[i].to / mesh_->unit);
  }
  return std::move(mesh_);
}

}  // namespace pd::render::detail
