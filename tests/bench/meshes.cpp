#include "bench/meshes.hpp"

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

struct Extent {
  Vec3 middle;
  double size;
};

Extent extent_of(const scenes::Points& points) {
  Vec3 low = points[0];
  Vec3 high = points[0];
  for (const Vec3& p : points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  return {0.5 * (low + high), (high - low).maxCoeff()};
}

Vec3 extreme(const scenes::Points& points, const Pose& pose, const Vec3& direction) {
  return *std::max_element(points.begin(), points.end(), [&](const Vec3& p, const Vec3& q) {
    return pose.apply(p).dot(direction) < pose.apply(q).dot(direction);
  });
}

/// Random attitudes; then as the scenes place their families: extreme points meet and go on by a share of the size, or
/// the middles nearly coincide.
Draw placed(const NamedShape& a, const NamedShape& b, DepthClass depth, scenes::Random& random) {
  const scenes::Points points_a = vertices_of(a.shape);
  const scenes::Points points_b = vertices_of(b.shape);
  const Pose pose_a = *Pose::from_quaternion(random.quaternion(), Vec3::Zero());
  const Pose pose_b = *Pose::from_quaternion(random.quaternion(), Vec3::Zero());
  const Vec3 d = random.direction();
  Vec3 t;
  if (depth == DepthClass::deep) {
    t = pose_a.apply(extent_of(points_a).middle) - pose_b.apply(extent_of(points_b).middle) + 1e-3 * d;
  } else {
    const double share = depth == DepthClass::shallow ? 0.01 : 0.1;
    t = pose_a.apply(extreme(points_a, pose_a, d)) - pose_b.apply(extreme(points_b, pose_b, -d)) - share * d;
  }
  return {{a.shape, b.shape}, pose_a, *Pose::from_quaternion(pose_b.quaternion_wxyz(), t)};
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
    for (Vec3& p : points) p = (p - extent.middle) / extent.size;
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
        const Draw d = placed(mesh, meshes[partner], depth, random);
        ++(measure_draw(d, solvers, kSlowNs, sits_out, tallies) ? done : refused);
      }
      const std::vector<Row> block = rows_of(solvers, tallies, mesh.name, mesh.shape.polytope()->num_vertices(), depth);
      print_rows(block);
      rows.insert(rows.end(), block.begin(), block.end());
    }
  }
  return rows;
}

}  // namespace pd::bench
