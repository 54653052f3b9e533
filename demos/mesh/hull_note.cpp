#include "mesh/hull_note.hpp"

#include <array>
#include <cmath>
#include <cstdio>

namespace pd::query {

namespace {

/// Tells a person the first thing that keeps a mesh from being convex; empty for a convex mesh.
std::string reason_of(const SurfaceReport& report) {
  if (report.faces == 0) return "the file holds points and no faces";
  if (!report.has_area()) return "no face of the mesh has an area";
  if (!report.closed()) return "the mesh has holes";
  if (!report.oriented()) return "neighbouring faces of the mesh show opposite sides";
  if (!report.manifold()) return "more than two faces of the mesh share an edge, or its parts share a vertex";
  if (report.shells > 1) return "the mesh has several parts";
  if (!report.convex) return "the mesh is not convex";
  return report.loose_points == 0 ? "" : "points lie beside the surface, in no face or in faces without an area";
}

}  // namespace

double relative_volume(const ConvexPolytope& hull, double size) {
  if (hull.affine_dimension() < 3) return 0;
  double sum = 0;
  const auto seen = [&](std::int32_t v) -> Vec3 { return (hull.vertex(v) - hull.centre()) / size; };
  for (int f = 0; f < hull.num_facets(); ++f) {
    const auto loop = hull.facet_vertices(f);
    for (std::size_t k = 1; k + 1 < loop.size(); ++k) {
      sum += seen(loop[0]).dot(seen(loop[k]).cross(seen(loop[k + 1]))) / 6;
    }
  }
  return sum;
}

std::optional<HullNote> why_hull(const SurfaceReport& report, const ConvexPolytope& hull) {
  const std::string reason = reason_of(report);
  if (reason.empty()) return std::nullopt;
  HullNote note{reason, hull.num_vertices(), 0};
  const bool encloses = report.closed() && report.oriented() && report.relative_volume != 0;
  if (encloses) note.times_as_large = relative_volume(hull, report.size) / std::abs(report.relative_volume);
  return note;
}

namespace {

std::string words_of_left_out(std::int64_t count) {
  return count == 0 ? "" : " (left out: " + std::to_string(count) + " without a measurement, NaN)";
}

/// Crossings are the dearest part, and nothing hangs on them here: a surface that bends nowhere inwards has none.
Expected<SurfaceReport> quick_check(const MeshPoints& mesh) {
  return check_mesh({mesh.points, mesh.faces.offsets, mesh.faces.corners}, {.crossings = false});
}

}  // namespace

std::string not_convex_because(const MeshPoints& mesh) {
  const auto report = quick_check(mesh);
  return report ? reason_of(*report) + words_of_left_out(mesh.left_out) : report.error().message;
}

std::optional<HullNote> why_hull(const MeshPoints& mesh, const ConvexPolytope& hull) {
  const auto report = quick_check(mesh);
  if (!report) return HullNote{report.error().message, hull.num_vertices(), 0};
  std::optional<HullNote> note = why_hull(*report, hull);
  if (note) note->left_out = mesh.left_out;
  return note;
}

std::string in_words(const HullNote& note) {
  std::string words = "asked as the convex hull, since " + note.reason + words_of_left_out(note.left_out) + ": " +
                      std::to_string(note.vertices) + " vertices";
  if (note.times_as_large > 0) {
    std::array<char, 40> number{};
    std::snprintf(number.data(), number.size(), "%.4g", note.times_as_large);
    words += std::string(", ") + number.data() + " times the mesh's volume";
  }
  return words;
}

}  // namespace pd::query
