/// @file
/// glTF 2 (.gltf, .glb) through Assimp: every mesh of the scene, once for every node that shows it.
#include <assimp/BaseImporter.h>
#include <assimp/importerdesc.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

#include <Eigen/Core>
#include <assimp/Importer.hpp>
#include <memory>
#include <string_view>

#include "mesh/mesh_text.hpp"

namespace pd::query {

namespace {

using Mat4 = Eigen::Matrix4d;

Mat4 to_eigen(const aiMatrix4x4& m) {
  Mat4 result;
  for (unsigned i = 0; i < 4; ++i) {
    for (unsigned j = 0; j < 4; ++j) result(i, j) = double{m[i][j]};
  }
  return result;
}

struct SceneReader {
  const aiScene& scene;
  VertexCollector& vertices;

  void read_node(const aiNode& node, const Mat4& parent) {
    const Mat4 placement = parent * to_eigen(node.mTransformation);
    for (unsigned i = 0; i < node.mNumMeshes; ++i) read_mesh(*scene.mMeshes[node.mMeshes[i]], placement);
    for (unsigned i = 0; i < node.mNumChildren; ++i) read_node(*node.mChildren[i], placement);
  }

  void read_mesh(const aiMesh& mesh, const Mat4& placement) {
    const std::int64_t first = vertices.size();
    for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
      const aiVector3D& p = mesh.mVertices[v];
      const Eigen::Vector4d placed = placement * Eigen::Vector4d(double{p.x}, double{p.y}, double{p.z}, 1.0);
      vertices.add(placed.head<3>());
    }
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      for (unsigned k = 0; k < mesh.mFaces[f].mNumIndices; ++k) {
        if (!vertices.reference(first + mesh.mFaces[f].mIndices[k])) {
          refuse("unreadable_file", "a face names a vertex that is not there", "");
        }
      }
    }
  }
};

/// Leaves no reader but those of glTF: by its first bytes a file of that name would else be given to any of fifty, some
/// of which never come to an end.
void keep_gltf_only(Assimp::Importer& importer) {
  for (std::size_t i = importer.GetImporterCount(); i-- > 0;) {
    const aiImporterDesc* const description = importer.GetImporterInfo(i);
    if (std::string_view(description->mFileExtensions).find("gltf") != std::string_view::npos) continue;
    const std::unique_ptr<Assimp::BaseImporter> other(importer.GetImporter(i));
    importer.UnregisterLoader(other.get());
  }
}

}  // namespace

MeshPoints read_gltf(const std::string& path, std::int64_t max_vertices) {
  Assimp::Importer importer;
  keep_gltf_only(importer);
  const aiScene* scene = importer.ReadFile(path, 0);
  if (scene == nullptr || scene->mRootNode == nullptr) {
    refuse("unreadable_file", std::string("no glTF that can be read: ") + importer.GetErrorString(), "");
  }
  VertexCollector vertices(max_vertices);
  SceneReader{*scene, vertices}.read_node(*scene->mRootNode, Mat4::Identity());
  return std::move(vertices).finish();
}

}  // namespace pd::query
