#include "pd/shape/mesh_check.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "numeric/number_text.hpp"
#include "pd/numeric/predicates.hpp"
#include "pd/shape/pose.hpp"
#include "shape/hull/disjoint_sets.hpp"
#include "shape/mesh/polygon_triangles.hpp"
#include "shape/mesh/triangle_crossings.hpp"
#include "shape/mesh/welded_mesh.hpp"

namespace pd {

namespace {

using detail::DisjointSets;
using detail::EdgeUse;
using detail::FaceTriangle;
using detail::number_text;
using detail::WeldedMesh;

std::optional<Error> bad_input(const MeshView& mesh) {
  if (mesh.points.empty()) return Error{ErrorCode::too_few_points, "a mesh needs points", ""};
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    if (!mesh.points[i].allFinite()) {
      return Error{ErrorCode::non_finite, "coordinates must be finite numbers", "vertices[" + std::to_string(i) + "]"};
    }
    const double largest = mesh.points[i].cwiseAbs().maxCoeff();
    if (largest > kMaxCoordinate) {
      return Error{ErrorCode::out_of_range,
                   number_text(largest) + " is beyond the largest coordinate " + number_text(kMaxCoordinate),
                   "vertices[" + std::to_string(i) + "]"};
    }
  }
  const auto corners = static_cast<std::int64_t>(mesh.corners.size());
  if (mesh.offsets.empty() || mesh.offsets.front() != 0 || mesh.offsets.back() != corners ||
      !std::is_sorted(mesh.offsets.begin(), mesh.offsets.end())) {
    return Error{ErrorCode::bad_faces, "offsets must rise from 0 to the number of corners", "offsets"};
  }
  for (std::size_t k = 0; k < mesh.corners.size(); ++k) {
    if (mesh.corners[k] < 0 || static_cast<std::size_t>(mesh.corners[k]) >= mesh.points.size()) {
      return Error{ErrorCode::bad_faces,
                   "vertex index " + std::to_string(mesh.corners[k]) + " is outside 0.." +
                       std::to_string(mesh.points.size() - 1),
                   "corners[" + std::to_string(k) + "]"};
    }
  }
  return std::nullopt;
}

/// A plane through a face: its corners' mean, and a unit normal; zero for a face without an area.
struct FacePlane {
  Vec3 centre = Vec3::Zero();
  Vec3 normal = Vec3::Zero();
  [[nodiscard]] double height(const Vec3& p) const { return normal.dot(p - centre); }
};

/// The set of each face, numbered from 0 in the order of their first faces; -1 for an empty loop.
std::vector<std::int32_t> numbered(const WeldedMesh& mesh, DisjointSets& faces) {
  std::vector<std::int32_t> of_face(static_cast<std::size_t>(mesh.num_faces()), -1), of_root = of_face;
  std::int32_t sets = 0;
  for (std::int32_t f = 0; f < mesh.num_faces(); ++f) {
    if (mesh.face(f).empty()) continue;
    std::int32_t& set = of_root[static_cast<std::size_t>(faces.find(f))];
    if (set < 0) set = sets++;
    of_face[static_cast<std::size_t>(f)] = set;
  }
  return of_face;
}

/// Unites the two faces of each edge that has no third.
void unite_over_lone_edges(const WeldedMesh& mesh, DisjointSets& faces) {
  const std::vector<EdgeUse> uses = detail::sorted_edges(mesh);
  const auto face_of = [&](const EdgeUse& use) { return mesh.face_of[static_cast<std::size_t>(use.corner)]; };
  for (std::size_t i = 0, end = 0; i < uses.size(); i = end) {
    for (end = i; end < uses.size() && uses[end].same_edge(uses[i]);) ++end;
    if (end - i == 2) faces.unite(face_of(uses[i]), face_of(uses[i + 1]));
  }
}

class MeshChecker {
 public:
  explicit MeshChecker(const MeshView& mesh) : mesh_(detail::weld(mesh)) {
    report_.points = static_cast<std::int64_t>(mesh.points.size());
    report_.vertices = mesh_.distinct;
    report_.faces = mesh_.num_faces();
    std::vector<char> on_surface(mesh.points.size(), 0);
    for (const std::int32_t v : mesh_.corners) on_surface[static_cast<std::size_t>(v)] = 1;
    report_.loose_points = mesh_.distinct - std::count(on_surface.begin(), on_surface.end(), 1);
    report_.low = report_.high = mesh.points.front();
    for (const Vec3& p : mesh.points) {
      report_.low = report_.low.cwiseMin(p);
      report_.high = report_.high.cwiseMax(p);
    }
    report_.size = (report_.high - report_.low).maxCoeff();
  }

  SurfaceReport check(const MeshCheckSettings& settings) {
    precision_ = kMeshPrecision * (settings.extent > 0 ? settings.extent : report_.size);
    find_planes();
    check_edges();
    if (report_.closed() && report_.oriented()) check_shells();
    report_.convex = report_.closed() && report_.oriented() && report_.manifold() && report_.shells == 1 &&
                     report_.relative_volume != 0 && deepest_bend_[report_.relative_volume < 0 ? 1 : 0] <= precision_;
    if (settings.crossings) check_crossings();
    std::stable_sort(report_.findings.begin(), report_.findings.end(),
                     [](const MeshFinding& a, const MeshFinding& b) { return a.fault < b.fault; });
    return std::move(report_);
  }

 private:
  void add(const MeshFinding& finding) {
    std::int64_t& count = report_.counts[static_cast<std::size_t>(finding.fault)];
    if (++count <= static_cast<std::int64_t>(kShownFindings)) report_.findings.push_back(finding);
  }
  [[nodiscard]] std::int32_t face_of(std::int32_t corner) const {
    return mesh_.face_of[static_cast<std::size_t>(corner)];
  }

  void find_planes() {
    planes_.resize(static_cast<std::size_t>(mesh_.num_faces()));
    for (std::int32_t f = 0; f < mesh_.num_faces(); ++f) {
      const auto loop = mesh_.face(f);
      FacePlane& plane = planes_[static_cast<std::size_t>(f)];
      // Divided by the size before it is multiplied: areas of tiny and of huge meshes leave the range of doubles.
      Vec3 area = Vec3::Zero();
      for (std::size_t k = 1; k + 1 < loop.size(); ++k)
        area += scaled(loop[0], loop[k]).cross(scaled(loop[0], loop[k + 1]));
      const double length = area.norm();
      if (length == 0) {
        add({.fault = MeshFault::degenerate_face, .faces = {f, -1}});
        continue;
      }
      plane.normal = area / length;
      for (const std::int32_t v : loop)
        plane.centre += mesh_.points[static_cast<std::size_t>(v)] / static_cast<double>(loop.size());
      double off = 0;
      for (const std::int32_t v : loop)
        off = std::max(off, std::abs(plane.height(mesh_.points[static_cast<std::size_t>(v)])));
      if (loop.size() > 3 && off > precision_) add({.fault = MeshFault::not_planar, .faces = {f, -1}});
    }
  }
  [[nodiscard]] Vec3 scaled(std::int32_t from, std::int32_t to) const {
    return (mesh_.points[static_cast<std::size_t>(to)] - mesh_.points[static_cast<std::size_t>(from)]) / report_.size;
  }

  void check_edges() {
    const std::vector<EdgeUse> uses = detail::sorted_edges(mesh_);
    DisjointSets faces(planes_.size());
    DisjointSets fans(mesh_.corners.size());
    // Vertices at a faulty edge, whose fans are broken for that reason already.
    std::vector<char> faulty(mesh_.points.size(), 0);
    for (std::size_t i = 0, end = 0; i < uses.size(); i = end) {
      for (end = i; end < uses.size() && uses[end].same_edge(uses[i]); ++end) {
        faces.unite(face_of(uses[i].corner), face_of(uses[end].corner));
      }
      const std::int32_t c = uses[i].corner, d = uses[i + (end > i + 1 ? 1 : 0)].corner;
      const std::array<std::int32_t, 2> edge = {uses[i].low, uses[i].high};
      if (end - i != 2 || mesh_.vertex(c) == mesh_.vertex(d)) {
        const MeshFault fault = end - i == 1   ? MeshFault::open_edge
                                : end - i == 2 ? MeshFault::flipped_face
                                               : MeshFault::not_manifold;
        add({.fault = fault, .edge = edge, .faces = {face_of(c), end - i == 1 ? -1 : face_of(d)}});
        for (const std::int32_t v : edge) faulty[static_cast<std::size_t>(v)] = 1;
        continue;
      }
      fans.unite(c, mesh_.next(d));
      fans.unite(mesh_.next(c), d);
      for (const std::size_t side : {std::size_t{0}, std::size_t{1}})
        deepest_bend_[side] = std::max(deepest_bend_[side], bend(c, d, side == 0 ? 1 : -1));
    }
    check_fans(fans, faulty);
    shell_of_ = numbered(mesh_, faces);
    for (const std::int32_t shell : shell_of_) report_.shells = std::max<std::int64_t>(report_.shells, shell + 1);
  }

  /// How far two faces bend towards each other at their common edge: the height of one above the other's plane, by
  /// that plane which says less, since a small face's plane is uncertain far away.
  /// @param side  1 where faces show their outside, -1 where they show their inside
  [[nodiscard]] double bend(std::int32_t c, std::int32_t d, double side) const {
    const auto above = [&](std::int32_t base, std::int32_t other) {
      const FacePlane& plane = planes_[static_cast<std::size_t>(face_of(base))];
      const FacePlane& there = planes_[static_cast<std::size_t>(face_of(other))];
      if (plane.normal.isZero(0) || there.normal.isZero(0)) return 0.0;
      return std::max({side * plane.height(there.centre), side * plane.height(mesh_.point(mesh_.previous(other))),
                       side * plane.height(mesh_.point(mesh_.next(mesh_.next(other))))});
    };
    return std::min(above(c, d), above(d, c));
  }

  /// The corners at a vertex form one fan where they are joined by edges.
  void check_fans(DisjointSets& fans, const std::vector<char>& faulty) {
    std::vector<std::int32_t> first(mesh_.points.size(), -1);
    std::vector<char> told(mesh_.points.size(), 0);
    for (std::int32_t c = 0; c < static_cast<std::int32_t>(mesh_.corners.size()); ++c) {
      const auto v = static_cast<std::size_t>(mesh_.vertex(c));
      if (faulty[v] != 0 || told[v] != 0) continue;
      if (first[v] < 0) first[v] = c;
      if (fans.find(c) == fans.find(first[v])) continue;
      told[v] = 1;
      add({.fault = MeshFault::not_manifold, .edge = {mesh_.vertex(c), -1}, .faces = {face_of(first[v]), face_of(c)}});
    }
  }

  struct Shell {
    double volume = 0;
    Vec3 low = Vec3::Constant(HUGE_VAL), high = Vec3::Constant(-HUGE_VAL);
    std::int32_t face = -1;
    [[nodiscard]] bool holds(const Shell& other) const {
      return (low.array() <= other.low.array()).all() && (other.high.array() <= high.array()).all();
    }
  };

  /// A shell of negative volume is a cavity where a shell of positive volume surrounds it, and else inside out.
  void check_shells() {
    std::vector<Shell> shells(static_cast<std::size_t>(report_.shells));
    const Vec3 middle = 0.5 * report_.low + 0.5 * report_.high;
    for (std::int32_t f = 0; f < mesh_.num_faces(); ++f) {
      const auto loop = mesh_.face(f);
      if (loop.empty()) continue;
      Shell& shell = shells[static_cast<std::size_t>(shell_of_[static_cast<std::size_t>(f)])];
      if (shell.face < 0) shell.face = f;
      const auto seen = [&](std::int32_t v) -> Vec3 {
        return (mesh_.points[static_cast<std::size_t>(v)] - middle) / report_.size;
      };
      for (std::size_t k = 1; k + 1 < loop.size(); ++k) {
        shell.volume += seen(loop[0]).dot(seen(loop[k]).cross(seen(loop[k + 1]))) / 6;
      }
      for (const std::int32_t v : loop) {
        shell.low = shell.low.cwiseMin(mesh_.points[static_cast<std::size_t>(v)]);
        shell.high = shell.high.cwiseMax(mesh_.points[static_cast<std::size_t>(v)]);
      }
    }
    double sum = 0;
    for (const Shell& shell : shells) {
      sum += shell.volume;
      const bool cavity = std::any_of(shells.begin(), shells.end(),
                                      [&](const Shell& other) { return other.volume > 0 && other.holds(shell); });
      if (shell.volume < 0 && !cavity) add({.fault = MeshFault::inside_out, .faces = {shell.face, -1}});
    }
    report_.relative_volume = sum;
  }

  void check_crossings() {
    std::vector<FaceTriangle> triangles;
    std::vector<std::array<std::int32_t, 3>> parts;
    report_.crossings_searched = true;
    for (std::int32_t f = 0; f < mesh_.num_faces(); ++f) {
      const FacePlane& plane = planes_[static_cast<std::size_t>(f)];
      if (plane.normal.isZero(0)) continue;
      parts.clear();
      if (!detail::append_triangles(mesh_.points, mesh_.face(f), plane.normal, parts))
        report_.crossings_searched = false;
      for (const auto& part : parts) triangles.push_back({part, f});
    }
    constexpr std::int64_t kVisitsPerTriangle = 64, kFewVisits = 1'000'000;
    const std::int64_t budget = kFewVisits + kVisitsPerTriangle * static_cast<std::int64_t>(triangles.size());
    std::vector<std::array<std::int32_t, 2>> crossings;
    const bool searched = detail::find_crossings(mesh_.points, triangles, budget, [&](std::int32_t f, std::int32_t g) {
      crossings.push_back({f, g});
    });
    // Two polygons may cross in several of their triangles.
    std::sort(crossings.begin(), crossings.end());
    crossings.erase(std::unique(crossings.begin(), crossings.end()), crossings.end());
    for (const auto& faces : crossings) add({.fault = MeshFault::self_crossing, .faces = faces});
    report_.crossings_searched = report_.crossings_searched && searched;
  }

  WeldedMesh mesh_;
  SurfaceReport report_;
  double precision_ = 0;
  std::vector<FacePlane> planes_;
  std::vector<std::int32_t> shell_of_;
  std::array<double, 2> deepest_bend_{};  ///< inwards, for faces that show their outside and for those that do not
};

}  // namespace

std::string_view to_string(MeshFault fault) {
  constexpr std::array<std::string_view, kMeshFaults> kWords = {
      "open_edge", "flipped_face", "not_manifold", "self_crossing", "inside_out", "not_planar", "degenerate_face"};
  return kWords[static_cast<std::size_t>(fault)];
}

Expected<SurfaceReport> check_mesh(const MeshView& mesh, const MeshCheckSettings& settings) {
  if (auto error = bad_input(mesh)) return *std::move(error);
  return MeshChecker(mesh).check(settings);
}

std::vector<std::int32_t> connected_surfaces(const MeshView& mesh) {
  const WeldedMesh welded = detail::weld(mesh);
  DisjointSets faces(static_cast<std::size_t>(welded.num_faces()));
  unite_over_lone_edges(welded, faces);
  // Solids that share a whole face have edges of four faces, which the stored indices tell apart.
  WeldedMesh stored = welded;
  stored.corners.clear();
  stored.face_of.clear();
  stored.offsets.assign(1, 0);
  for (std::int32_t f = 0; f < welded.num_faces(); ++f) {
    const auto at = static_cast<std::size_t>(f);
    if (!welded.face(f).empty()) {
      stored.corners.insert(stored.corners.end(), mesh.corners.begin() + mesh.offsets[at],
                            mesh.corners.begin() + mesh.offsets[at + 1]);
    }
    stored.offsets.push_back(static_cast<std::int32_t>(stored.corners.size()));
    stored.face_of.resize(stored.corners.size(), f);
  }
  unite_over_lone_edges(stored, faces);
  return numbered(welded, faces);
}

}  // namespace pd
