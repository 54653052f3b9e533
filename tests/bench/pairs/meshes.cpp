#include "bench/pairs/meshes.hpp"

#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <algorithm>
#include <assimp/Importer.hpp>

namespace pd::bench {

namespace {

using scenes::DepthClass;

scenes::Points points_of(const std::filesystem::path& file) {
  Assimp::Importer importer;
  const aiScene* scene =
      importer.ReadFile(file.string(), aiProcess_PreTransformVertices | aiProcess_JoinIdenticalVertices);
  scenes::Points points;
  if (scene == nullptr) return points;
  for (unsigned m = 0; m < scene->mNumMeshes; ++m) {
    const aiMesh& mesh = *scene->mMeshes[m];
    for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
      const aiVector3D& p = mesh.mVertices[v];
      points.emplace_back(p.x, p.y, p.z);
    }
  }
  return points;
}

}  // namespace

Expected<std::vector<NamedShape>> read_meshes(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  std::error_code failed;
  for (std::filesystem::recursive_directory_iterator it(folder, failed), end; !failed && it != end;
       it.increment(failed)) {
    std::string ending = it->path().extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
    for (const std::string_view known : {".obj", ".stl", ".ply", ".off", ".gltf", ".glb"}) {
      if (ending == known) files.push_back(it->path());
    }
  }
  if (failed) return Error{ErrorCode::bad_value, failed.message(), folder.string()};
  std::sort(files.begin(), files.end());
  std::vector<NamedShape> meshes;
  for (const std::filesystem::path& file : files) {
    scenes::Points points = points_of(file);
    auto hull = ConvexPolytope::from_points(points);
    if (!hull || hull->affine_dimension() < 3) {
      fmt::print(stderr, "{}: {}, left out\n", file.string(), hull ? "flat" : hull.error().message);
      continue;
    }
    // To size 1, so that depths mean the same for all.
    const Extent extent = extent_of(points);
    for (Vec3& p : points) p = (p - extent.middle) / extent.size.maxCoeff();
    meshes.push_back({file.stem().string(), ConvexShape(*ConvexPolytope::from_points(points))});
  }
  if (meshes.empty()) return Error{ErrorCode::bad_value, "no mesh with a solid hull", folder.string()};
  return meshes;
}

std::vector<Row> run_meshes(const std::vector<NamedShape>& meshes, int pairs, std::uint64_t seed, Solvers& solvers) {
  std::vector<Row> rows;
  scenes::Random random(seed);
  print_header();
  for (const NamedShape& mesh : meshes) {
    std::vector<char> sits_out(solvers.size(), 0);
    for (const DepthClass depth : {DepthClass::shallow, DepthClass::mid, DepthClass::deep}) {
      std::vector<Tally> tallies(solvers.size());
      int refused = 0;
      for (int done = 0; done < pairs && refused < 20 * pairs;) {
        const auto partner = static_cast<std::size_t>(random.integer(0, static_cast<int>(meshes.size()) - 1));
        const Draw d = placed({mesh.shape, meshes[partner].shape}, 1, depth, random);
        ++(measure_draw(d, solvers, kSlowNs, sits_out, tallies) ? done : refused);
      }
      const std::vector<Row> block = rows_of(solvers, tallies, mesh.name, mesh.shape.polytope()->num_vertices(),
                                             scenes::to_string(depth), kBulletEpa);
      print_rows(block);
      rows.insert(rows.end(), block.begin(), block.end());
    }
  }
  return rows;
}

}  // namespace pd::bench
