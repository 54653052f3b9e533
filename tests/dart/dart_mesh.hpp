/// @file
/// Meshes of DART from hulls, for tests and measurements.
#pragma once

#include <assimp/scene.h>

#include <dart/dynamics/MeshShape.hpp>
#include <memory>
#include <vector>

#include "pd/shape/convex_polytope.hpp"

namespace pd::test {

/// The triangles of a hull's facets, as a reader of files would give them: corners in single precision.
/// @param left_out  triangles at the end that are missing
inline dart::dynamics::ShapePtr dart_mesh(const ConvexPolytope& hull, int left_out = 0) {
  std::vector<unsigned int> corners;
  for (int f = 0; f < hull.num_facets(); ++f) {
    const auto around = hull.facet_vertices(f);
    for (std::size_t c = 2; c < around.size(); ++c) {
      for (const int v : {around[0], around[c - 1], around[c]}) corners.push_back(static_cast<unsigned int>(v));
    }
  }
  Vec3 middle = Vec3::Zero();
  for (int v = 0; v < hull.num_vertices(); ++v) middle += hull.vertex(v) / hull.num_vertices();
  auto* scene = new aiScene;
  auto* mesh = new aiMesh;
  scene->mNumMeshes = 1;
  scene->mMeshes = new aiMesh* [1] { mesh };
  scene->mRootNode = new aiNode;
  mesh->mNumVertices = static_cast<unsigned int>(hull.num_vertices());
  mesh->mVertices = new aiVector3D[mesh->mNumVertices];
  mesh->mNormals = new aiVector3D[mesh->mNumVertices];  // DART's ODE detector reads them
  for (int v = 0; v < hull.num_vertices(); ++v) {
    const Vec3 p = hull.vertex(v);
    mesh->mVertices[v] = aiVector3D(static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z()));
    const Vec3 outward = (p - middle).normalized();
    mesh->mNormals[v] =
        aiVector3D(static_cast<float>(outward.x()), static_cast<float>(outward.y()), static_cast<float>(outward.z()));
  }
  mesh->mNumFaces = static_cast<unsigned int>(corners.size() / 3) - static_cast<unsigned int>(left_out);
  mesh->mFaces = new aiFace[mesh->mNumFaces];
  for (unsigned int f = 0; f < mesh->mNumFaces; ++f) {
    mesh->mFaces[f].mNumIndices = 3;
    mesh->mFaces[f].mIndices = new unsigned int[3]{corners[3 * f], corners[3 * f + 1], corners[3 * f + 2]};
  }
  return std::make_shared<dart::dynamics::MeshShape>(Vec3(1, 1, 1), scene);
}

}  // namespace pd::test
