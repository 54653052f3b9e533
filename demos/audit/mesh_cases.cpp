#include "audit/mesh_cases.hpp"

#include <fmt/format.h>
#include <stdlib.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "mesh/mesh_file.hpp"
#include "protocol/line/json_writer.hpp"
#include "protocol/line/limits.hpp"
#include "scenes/shape_families.hpp"
#include "support/refusal.hpp"

namespace pd::audit {

namespace {

struct Hull {
  std::string name;
  std::vector<Vec3> vertices;
};

std::vector<std::string> mesh_files(const std::string& folder) {
  std::vector<std::string> files;
  std::error_code error;
  for (std::filesystem::recursive_directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    if (query::is_mesh_name(it->path())) files.push_back(it->path().string());
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::vector<Hull> hulls_of(const std::string& folder, std::vector<std::string>& complaints) {
  const query::Limits limits;
  std::vector<Hull> hulls;
  for (const std::string& file : mesh_files(folder)) {
    try {
      const auto mesh = query::read_mesh_points(file, limits.max_vertices, query::kMaxMeshBytes);
      const auto hull = ConvexPolytope::from_points(mesh.points);
      if (!hull) {
        complaints.push_back(fmt::format("{} is left out: {}", file, hull.error().message));
        continue;
      }
      hulls.push_back({file, {}});
      for (int v = 0; v < hull->num_vertices(); ++v) hulls.back().vertices.push_back(hull->vertex(v));
    } catch (const query::Refusal& refusal) {
      complaints.push_back(fmt::format("{} is left out: {}", file, refusal.message));
    }
  }
  return hulls;
}

Vec3 extreme(const Hull& hull, const Pose& pose, const Vec3& direction) {
  const Vec3 local = pose.rotation().transpose() * direction;
  return pose.rotation() * *std::max_element(hull.vertices.begin(), hull.vertices.end(),
                                             [&](const Vec3& p, const Vec3& q) { return p.dot(local) < q.dot(local); });
}

struct HullBox {
  Vec3 centre;
  double size;
};

HullBox box_of(const Hull& hull) {
  Vec3 low = hull.vertices.front();
  Vec3 high = low;
  for (const Vec3& p : hull.vertices) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  return {0.5 * (low + high), (high - low).maxCoeff()};
}

/// Where B stands, A standing at the origin in its own attitude.
Vec3 place(const Hull& a, const Pose& pose_a, const Hull& b, const Pose& pose_b, scenes::DepthClass depth,
           scenes::Random& random) {
  const double size = std::min(box_of(a).size, box_of(b).size);
  const Vec3 direction = random.direction();
  if (depth == scenes::DepthClass::deep) {
    return pose_a.rotation() * box_of(a).centre - pose_b.rotation() * box_of(b).centre + 1e-3 * size * direction;
  }
  const double share = depth == scenes::DepthClass::gap ? -0.01 : depth == scenes::DepthClass::shallow ? 0.01 : 0.1;
  return extreme(a, pose_a, direction) - extreme(b, pose_b, -direction) - share * size * direction;
}

void write_pose(std::string_view key, const Vec3& translation, const std::array<double, 4>& q,
                query::JsonWriter& json) {
  json.key(key).begin_object().key("translation").vector(translation).key("quaternion_wxyz").begin_array();
  for (const double x : q) json.number(x);
  json.end_array().end_object();
}

std::string shape_line(const Hull& hull) {
  std::string text;
  query::JsonWriter json(text);
  json.begin_object().key("shape").string(hull.name).key("is").begin_object().key("type").string("convex");
  json.key("vertices").begin_array();
  for (const Vec3& p : hull.vertices) json.vector(p);
  json.end_array().end_object().end_object();
  return text + "\n";
}

std::string contact_line(const Hull& a, const Hull& b, int depth, int number, std::uint64_t seed) {
  scenes::Random random(seed);
  const auto turn_a = random.quaternion();
  const auto turn_b = random.quaternion();
  const Pose pose_a = Pose::from_quaternion(turn_a, Vec3::Zero()).value();
  const Pose pose_b = Pose::from_quaternion(turn_b, Vec3::Zero()).value();
  std::string text;
  query::JsonWriter json(text);
  json.begin_object().key("contact").integer(number).key("a").string(a.name);
  write_pose("pose_a", Vec3::Zero(), turn_a, json);
  json.key("b").string(b.name);
  write_pose("pose_b", place(a, pose_a, b, pose_b, static_cast<scenes::DepthClass>(depth), random), turn_b, json);
  json.key("reported").null();
  json.end_object();
  return text + "\n";
}

}  // namespace

MeshCases::MeshCases(const std::string& folder, const AccuracySettings& settings) {
  const std::vector<Hull> hulls = hulls_of(folder, complaints_);
  if (hulls.empty()) complaints_.push_back(folder + " holds no mesh that can be read");
  if (hulls.empty()) return;
  path_ = make_temporary_file("pdepth_meshes");
  std::ofstream file(path_, std::ios::binary);
  file << "{\"record\":\"pdepth-contacts/1\",\"engine\":\"nobody\",\"scalar\":\"float64\"}\n";
  for (const Hull& hull : hulls) file << shape_line(hull);
  int number = 0;
  for (std::size_t i = 0; i < hulls.size(); ++i) {
    for (int depth = 0; depth < scenes::kDepthClasses; ++depth) {
      for (int k = 0; k < settings.pairs; ++k, ++number) {
        file << contact_line(hulls[i], hulls[(i + 1) % hulls.size()], depth, number,
                             settings.seed * 1'000'003U + static_cast<std::uint64_t>(number));
      }
    }
  }
  good_ = file.flush().good();
}

MeshCases::~MeshCases() {
  if (good_) ::unlink(path_.c_str());
}

}  // namespace pd::audit
