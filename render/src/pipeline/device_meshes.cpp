#include "pipeline/device_meshes.hpp"

#include <cstddef>

namespace pd::render::detail {
namespace {

void attribute(const GlFunctions& gl, GLuint index, GLint count, std::size_t stride, std::size_t offset) {
  gl.EnableVertexAttribArray(index);
  gl.VertexAttribPointer(index, count, GL_FLOAT, GL_FALSE, static_cast<GLsizei>(stride),
                         reinterpret_cast<const void*>(offset));
}

}  // namespace

const DeviceMesh& DeviceMeshes::get(const MeshRef& mesh) {
  Entry& entry = entries_[mesh.get()];
  // An address may have been given to a new mesh since.
  if (entry.owner.expired()) {
    if (entry.device.surface != 0) {
      free(entry.device);
    }
    entry = Entry{mesh, upload(*mesh)};
  }
  return entry.device;
}

void DeviceMeshes::collect() {
  for (auto entry = entries_.begin(); entry != entries_.end();) {
    if (entry->second.owner.expired()) {
      free(entry->second.device);
      entry = entries_.erase(entry);
    } else {
      ++entry;
    }
  }
}

DeviceMesh DeviceMeshes::upload(const Mesh& mesh) const {
  const GlFunctions& gl = *gl_;
  DeviceMesh device;
  device.index_count = static_cast<GLsizei>(mesh.triangles.size());

  gl.GenVertexArrays(1, &device.surface);
  gl.BindVertexArray(device.surface);
  gl.GenBuffers(1, &device.vertex_buffer);
  gl.BindBuffer(GL_ARRAY_BUFFER, device.vertex_buffer);
  gl.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(mesh.vertices.size() * sizeof(Mesh::Vertex)),
                mesh.vertices.data(), GL_STATIC_DRAW);
  attribute(gl, 0, 3, sizeof(Mesh::Vertex), offsetof(Mesh::Vertex, position));
  attribute(gl, 1, 3, sizeof(Mesh::Vertex), offsetof(Mesh::Vertex, normal));
  attribute(gl, 2, 4, sizeof(Mesh::Vertex), offsetof(Mesh::Vertex, tint));
  gl.GenBuffers(1, &device.index_buffer);
  gl.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, device.index_buffer);
  gl.BufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(mesh.triangles.size() * sizeof(std::uint32_t)),
                mesh.triangles.data(), GL_STATIC_DRAW);

  gl.GenVertexArrays(1, &device.edges);
  gl.BindVertexArray(device.edges);
  gl.GenBuffers(1, &device.edge_buffer);
  gl.BindBuffer(GL_ARRAY_BUFFER, device.edge_buffer);
  std::vector<Mesh::Edge> corners;
  std::vector<std::uint32_t> indices;
  for (const Mesh::Edge& edge : mesh.feature_edges) {
    const auto first = static_cast<std::uint32_t>(corners.size());
    corners.insert(corners.end(), 4, edge);
    indices.insert(indices.end(), {first, first + 1, first + 2, first + 2, first + 1, first + 3});
  }
  device.edge_index_count = static_cast<GLsizei>(indices.size());
  gl.BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(corners.size() * sizeof(Mesh::Edge)), corners.data(),
                GL_STATIC_DRAW);
  attribute(gl, 0, 3, sizeof(Mesh::Edge), offsetof(Mesh::Edge, from));
  attribute(gl, 1, 3, sizeof(Mesh::Edge), offsetof(Mesh::Edge, to));
  attribute(gl, 2, 3, sizeof(Mesh::Edge), offsetof(Mesh::Edge, normal_left));
  attribute(gl, 3, 3, sizeof(Mesh::Edge), offsetof(Mesh::Edge, normal_right));
  gl.GenBuffers(1, &device.edge_index_buffer);
  gl.BindBuffer(GL_ELEMENT_ARRAY_BUFFER, device.edge_index_buffer);
  gl.BufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(indices.size() * sizeof(std::uint32_t)),
                indices.data(), GL_STATIC_DRAW);
  gl.BindVertexArray(0);
  return device;
}

void DeviceMeshes::free(const DeviceMesh& mesh) const {
  gl_->DeleteVertexArrays(1, &mesh.surface);
  gl_->DeleteVertexArrays(1, &mesh.edges);
  gl_->DeleteBuffers(1, &mesh.vertex_buffer);
  gl_->DeleteBuffers(1, &mesh.index_buffer);
  gl_->DeleteBuffers(1, &mesh.edge_buffer);
  gl_->DeleteBuffers(1, &mesh.edge_index_buffer);
}

}  // namespace pd::render::detail
