#include "pd/shape/mesh_solid.hpp"

#include <algorithm>
#include <span>
#include <tuple>
#include <utility>

#include "numeric/floating_point_guard.hpp"
#include "shape/hull/disjoint_sets.hpp"
#include "shape/mesh/polygon_triangles.hpp"
#include "shape/mesh/triangle_tree.hpp"
#include "shape/mesh/welded_mesh.hpp"
#include "solid/posed_solids.hpp"
#include "solid/winding.hpp"

namespace pd {

namespace {

using detail::DisjointSets;

/// The loops, each run backwards.
struct TurnedMesh {
  std::vector<std::int32_t> corners;
  explicit TurnedMesh(const MeshView& mesh) : corners(mesh.corners.begin(), mesh.corners.end()) {
    for (std::size_t f = 0; f + 1 < mesh.offsets.size(); ++f) {
      std::reverse(corners.begin() + mesh.offsets[f], corners.begin() + mesh.offsets[f + 1]);
    }
  }
};

Vec3 normal_of(std::span<const Vec3> points, std::span<const std::int32_t> loop, double size) {
  const auto seen = [&](std::size_t k) -> Vec3 {
    return (points[static_cast<std::size_t>(loop[k])] - points[static_cast<std::size_t>(loop[0])]) / size;
  };
  Vec3 area = Vec3::Zero();
  for (std::size_t k = 1; k + 1 < loop.size(); ++k) area += seen(k).cross(seen(k + 1));
  return area;
}

Error degenerate(std::int32_t face) {
  return {ErrorCode::bad_faces,
          in_words({.fault = MeshFault::degenerate_face, .faces = {face, -1}}) +
              "; a solid needs faces with an area: leave such faces out and split their neighbours at the vertices",
          "faces[" + std::to_string(face) + "]"};
}

std::string edge_words(const std::array<std::int32_t, 2>& edge) {
  return edge[1] < 0 ? "vertex " + std::to_string(edge[0])
                     : "the edge of vertices " + std::to_string(edge[0]) + " and " + std::to_string(edge[1]);
}

std::string place_of(const MeshFinding& finding) {
  if (finding.faces[0] >= 0) return "faces[" + std::to_string(finding.faces[0]) + "]";
  return finding.edge[0] >= 0 ? "vertices[" + std::to_string(finding.edge[0]) + "]" : "";
}

}  // namespace

std::string in_words(const MeshFinding& finding) {
  const std::string word = std::string(to_string(finding.fault)) + ": ";
  const std::string face = "face " + std::to_string(finding.faces[0]);
  const std::string faces = "faces " + std::to_string(finding.faces[0]) + " and " + std::to_string(finding.faces[1]);
  switch (finding.fault) {
    case MeshFault::open_edge:
      return word + edge_words(finding.edge) + " belongs to " + face +
             " alone, so that the mesh has a hole there and bounds no solid";
    case MeshFault::flipped_face:
      return word + faces + " run along " + edge_words(finding.edge) +
             " in one direction, so that one of them shows its inside";
    case MeshFault::not_manifold:
      return word + "several sheets of the surface meet in " + edge_words(finding.edge) + ", " + faces + " among them";
    case MeshFault::self_crossing:
      return word + faces + " meet elsewhere than in a common edge or vertex";
    case MeshFault::inside_out:
      return word + face + " and the surface that it belongs to show their insides";
    case MeshFault::not_planar:
      return word + "the corners of " + face + " lie off a common plane; cut it into triangles";
    case MeshFault::degenerate_face:
      break;
  }
  return word + "the corners of " + face + " lie on one line";
}

std::optional<MeshFinding> fault_of_solid(const SurfaceReport& report, bool turn_faces) {
  for (const MeshFinding& finding : report.findings) {
    if (finding.fault == MeshFault::degenerate_face && report.has_area()) continue;
    if (finding.fault == MeshFault::inside_out && turn_faces && report.relative_volume < 0) continue;
    return finding;
  }
  return std::nullopt;
}

Expected<MeshSolid> MeshSolid::from_faces(const MeshView& mesh, const MeshSolidSettings& settings) {
  const Expected<SurfaceReport> report = check_mesh(mesh);
  if (!report) return report.error();
  return from_checked(mesh, *report, settings);
}

Expected<MeshSolid> MeshSolid::from_checked(const MeshView& mesh, const SurfaceReport& report,
                                            const MeshSolidSettings& settings) {
  const detail::FloatingPointGuard guard;
  if (report.faces == 0) return Error{ErrorCode::bad_faces, "a solid needs faces; there are points alone", "faces"};
  if (const auto fault = fault_of_solid(report, settings.turn_faces)) {
    const bool open = fault->fault == MeshFault::open_edge;
    return Error{open ? ErrorCode::not_closed : ErrorCode::bad_faces, in_words(*fault), place_of(*fault)};
  }
  if (!report.crossings_searched) {
    return Error{ErrorCode::limit_exceeded, "the search for faces that cross did not end", "faces"};
  }
  if (report.count(MeshFault::inside_out) > 0) {
    const TurnedMesh turned(mesh);
    const MeshView view{mesh.points, mesh.offsets, turned.corners};
    Expected<SurfaceReport> again = check_mesh(view, {.crossings = false});
    if (!again) return again.error();
    SurfaceReport found = *std::move(again);
    found.crossings_searched = true;
    return from_checked(view, found, {});
  }

  const detail::WeldedMesh welded = detail::weld(mesh);
  MeshSolid solid;
  solid.vertices_.assign(mesh.points.begin(), mesh.points.end());
  std::vector<std::array<std::int32_t, 3>> parts;
  for (std::int32_t f = 0; f < welded.num_faces(); ++f) {
    const auto loop = welded.face(f);
    if (loop.empty()) continue;
    const Vec3 normal = normal_of(mesh.points, loop, report.size);
    if (normal.isZero(0)) return degenerate(f);
    parts.clear();
    if (!detail::append_triangles(mesh.points, loop, normal, parts)) {
      return Error{ErrorCode::bad_faces, "a polygon crosses itself, or has too many corners to be cut into triangles",
                   "faces[" + std::to_string(f) + "]"};
    }
    if (parts.size() + 2 != loop.size()) return degenerate(f);
    for (const auto& part : parts) solid.triangles_.push_back({part, {-1, -1, -1}, f, 0});
  }
  if (auto error = solid.arrange()) return *std::move(error);
  if (solid.num_shells_ > 1) {
    if (const auto shell = detail::misplaced_shell(solid)) {
      const MeshFinding finding{.fault = MeshFault::inside_out, .faces = {solid.triangle(*shell).face, -1}};
      return Error{ErrorCode::bad_faces,
                   in_words(finding) +
                       ", or lies inside of another part: only a cavity lies inside of a part, and what "
                       "lies inside of a cavity is a part again",
                   place_of(finding)};
    }
  }
  return solid;
}

Expected<MeshSolid> MeshSolid::from_polytope(const ConvexPolytope& polytope) {
  if (polytope.affine_dimension() < 3) {
    return Error{ErrorCode::not_full_dimensional, "a flat polytope bounds no solid", ""};
  }
  MeshSolid solid;
  for (std::int32_t v = 0; v < polytope.num_vertices(); ++v) solid.vertices_.push_back(polytope.vertex(v));
  for (std::int32_t f = 0; f < polytope.num_facets(); ++f) {
    const auto loop = polytope.facet_vertices(f);
    for (std::size_t k = 1; k + 1 < loop.size(); ++k) {
      solid.triangles_.push_back({{loop[0], loop[k], loop[k + 1]}, {-1, -1, -1}, f, 0});
    }
  }
  if (auto error = solid.arrange()) return *std::move(error);
  return solid;
}

std::optional<Error> MeshSolid::arrange() {
  std::vector<detail::TriangleBox> boxes;
  boxes.reserve(triangles_.size());
  for (const Triangle& t : triangles_) boxes.push_back(detail::box_of(vertices_, t.vertices));
  detail::TriangleTree tree(boxes);
  std::vector<Triangle> sorted;
  sorted.reserve(triangles_.size());
  for (const std::int32_t t : tree.order()) sorted.push_back(triangles_[static_cast<std::size_t>(t)]);
  triangles_ = std::move(sorted);
  nodes_ = std::move(tree).take_nodes();

  struct EdgeSide {
    std::int32_t low, high, triangle, edge;
  };
  std::vector<EdgeSide> sides;
  sides.reserve(3 * triangles_.size());
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(triangles_[t].vertices[k], triangles_[t].vertices[(k + 1) % 3]);
      sides.push_back({low, high, static_cast<std::int32_t>(t), static_cast<std::int32_t>(k)});
    }
  }
  detail::sort_edges(sides, [](const EdgeSide& x, const EdgeSide& y) {
    return std::tie(x.high, x.triangle) < std::tie(y.high, y.triangle);
  });
  DisjointSets shells(triangles_.size());
  for (std::size_t i = 0; i < sides.size(); i += 2) {
    const EdgeSide& x = sides[i];
    const bool paired = i + 1 < sides.size() && sides[i + 1].low == x.low && sides[i + 1].high == x.high &&
                        (i + 2 == sides.size() || sides[i + 2].low != x.low || sides[i + 2].high != x.high);
    if (!paired) return degenerate(triangle(x.triangle).face);
    const EdgeSide& y = sides[i + 1];
    triangles_[static_cast<std::size_t>(x.triangle)].neighbours[static_cast<std::size_t>(x.edge)] = y.triangle;
    triangles_[static_cast<std::size_t>(y.triangle)].neighbours[static_cast<std::size_t>(y.edge)] = x.triangle;
    shells.unite(x.triangle, y.triangle);
  }
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    const auto root = static_cast<std::size_t>(shells.find(static_cast<std::int32_t>(t)));
    triangles_[t].shell = root == t ? num_shells_++ : triangles_[root].shell;
  }
  return std::nullopt;
}

}  // namespace pd
