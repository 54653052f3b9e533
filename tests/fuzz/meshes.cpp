/// @file
/// Any bytes as a mesh file, the first of them its format: points, or a refusal, a check of the faces that ends, and a
/// solid that overlaps itself.
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <string>

#include "fuzz/input.hpp"
#include "mesh/mesh_file.hpp"
#include "pd/shape/mesh_check.hpp"
#include "pd/solid/solid_depth.hpp"
#include "support/refusal.hpp"

namespace {

/// A mesh without a fault is a solid, and a solid overlaps itself. Faces without an area, and surfaces inside of each
/// other, are told apart later than by the report.
void judge_solid(const pd::MeshView& mesh, const pd::SurfaceReport& report) {
  const auto solid = pd::MeshSolid::from_checked(mesh, report, {.turn_faces = true});
  const bool simple = report.count(pd::MeshFault::degenerate_face) == 0 && report.shells == 1;
  PD_LAW(solid || !report.solid() || !report.crossings_searched || !simple);
  if (!solid) return;
  const pd::PosedSolid posed{&*solid, pd::Pose()};
  PD_LAW(pd::classify(posed, posed) == pd::ContactClass::overlapping);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  constexpr std::array kFormats = {"obj", "stl", "ply", "off", "gltf", "glb"};
  const std::string path = "/tmp/pd_fuzz_" + std::to_string(::getpid()) + "." +
                           kFormats[static_cast<std::size_t>(data[0]) % kFormats.size()];
  std::FILE* const file = std::fopen(path.c_str(), "wb");
  if (file == nullptr) return 0;
  (void)std::fwrite(data + 1, 1, size - 1, file);
  (void)std::fclose(file);
  try {
    const auto mesh = pd::query::read_mesh_points(path, 10'000, std::uintmax_t{1} << 20);
    PD_LAW(mesh.ids.empty() || mesh.ids.size() == mesh.points.size());
    const pd::MeshView view{mesh.points, mesh.faces.offsets, mesh.faces.corners};
    if (const auto report = pd::check_mesh(view)) {
      PD_LAW(std::isfinite(report->relative_volume));
      PD_LAW(!report->convex || (report->closed() && report->oriented() && report->manifold()));
      constexpr std::int64_t kMostFaces = 200;
      if (mesh.faces.size() <= kMostFaces) judge_solid(view, *report);
    }
  } catch (const pd::query::Refusal&) {
  }
  (void)std::remove(path.c_str());
  return 0;
}
