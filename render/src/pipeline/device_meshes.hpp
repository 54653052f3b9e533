/// @file
/// Meshes on the device, for as long as their owners keep them.
#pragma once

#include <map>

#include "gl/gl_functions.hpp"
#include "pd/render/mesh.hpp"

namespace pd::render::detail {

/// Vertex arrays of one mesh. Attributes of `surface`: 0 position, 1 normal, 2 tint. Of `edges`: 0 from, 1 to, 2 and 3
/// the normals on both sides, the same at an edge's four corners (vertex number modulo 4). Instances would save the
/// copies, but software rasterisers set each one up anew.
struct DeviceMesh {
  GLuint surface = 0;
  GLuint edges = 0;
  GLsizei index_count = 0;
  GLsizei edge_index_count = 0;
  GLuint vertex_buffer = 0;
  GLuint index_buffer = 0;
  GLuint edge_buffer = 0;
  GLuint edge_index_buffer = 0;
};

class DeviceMeshes {
 public:
  explicit DeviceMeshes(const GlFunctions& gl) : gl_(&gl) {}

  /// Uploads on first sight.
  const DeviceMesh& get(const MeshRef& mesh);
  /// Frees what belongs to meshes that nobody holds any more.
  void collect();

 private:
  struct Entry {
    std::weak_ptr<const Mesh> owner;
    DeviceMesh device;
  };

  [[nodiscard]] DeviceMesh upload(const Mesh& mesh) const;
  void free(const DeviceMesh& mesh) const;

  const GlFunctions* gl_;
  std::map<const Mesh*, Entry> entries_;
};

}  // namespace pd::render::detail
