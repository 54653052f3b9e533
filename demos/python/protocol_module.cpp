/// @file
/// The module `pdepth._protocol`: lines of the protocol, mesh files, and the judge of contact records.
#include <fcntl.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <map>
#include <numeric>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "audit/audit_answer.hpp"
#include "mesh/hull_note.hpp"
#include "mesh/mesh_file.hpp"
#include "pd/solid/solid_parts.hpp"
#include "protocol/answer_line.hpp"
#include "protocol/solid_reader.hpp"
#include "python/arrays.hpp"
#include "python/mesh_parts.hpp"
#include "python/rows.hpp"
#include "support/refusal.hpp"

namespace pd::python {

namespace {

std::string answer(const std::string& line) {
  const Unlocked unlocked;
  thread_local query::Session session;
  return query::answer_line(line, session).text;
}

/// Lines answered by several threads, in their order; the same bytes for any number of threads.
std::vector<std::string> answer_many(const std::vector<std::string>& lines, int threads) {
  const Unlocked unlocked;
  std::vector<std::string> answers(lines.size());
  for_each_row(
      static_cast<std::int64_t>(lines.size()), threads, [] { return query::Session(); },
      [&](std::int64_t i, query::Session& session) {
        const auto line = static_cast<std::size_t>(i);
        answers[line] = query::answer_line(lines[line], session).text;
      });
  return answers;
}

/// Points [n, 3], the file's own numbers of them, and with `check` what keeps the mesh from being convex (or "").
/// @param source  as `read_mesh` takes it
py::tuple mesh_points(py::handle source, bool check) {
  try {
    const query::MeshPoints mesh = read_mesh(source);
    Array points({static_cast<py::ssize_t>(mesh.points.size()), py::ssize_t{3}});
    for (std::size_t i = 0; i < mesh.points.size(); ++i) {
      for (int k = 0; k < 3; ++k) points.mutable_at(static_cast<py::ssize_t>(i), k) = mesh.points[i][k];
    }
    return py::make_tuple(points, mesh.ids, check ? query::not_convex_because(mesh) : "");
  } catch (const query::Refusal& refusal) {
    refuse(refusal.code, refusal.message, py::isinstance<py::tuple>(source) ? "mesh" : source.cast<std::string>());
  }
}

/// Scales the points of a mesh along the axes. The faces of a mirrored mesh run the other way.
void rescale(query::MeshPoints& mesh, const Vec3& scale) {
  for (Vec3& point : mesh.points) point = point.cwiseProduct(scale);
  if (scale.prod() > 0) return;
  for (std::size_t f = 0; f + 1 < mesh.faces.offsets.size(); ++f) {
    std::reverse(mesh.faces.corners.begin() + mesh.faces.offsets[f],
                 mesh.faces.corners.begin() + mesh.faces.offsets[f + 1]);
  }
}

Array vertices_of(const ConvexPolytope& polytope) {
  Array points({static_cast<py::ssize_t>(polytope.num_vertices()), py::ssize_t{3}});
  for (int v = 0; v < polytope.num_vertices(); ++v) {
    for (int k = 0; k < 3; ++k) points.mutable_at(v, k) = polytope.vertex(v)[k];
  }
  return points;
}

query::MeshPoints scaled_mesh(const std::string& path, py::handle scale) {
  const query::Limits limits;
  query::MeshPoints mesh = query::read_mesh_points(path, limits.max_vertices, query::kMaxMeshBytes);
  if (mesh.faces.size() == 0) {
    query::refuse("bad_faces", "the file has points and no faces, so that it bounds no solid", "");
  }
  rescale(mesh, read_vector(scale, "scale"));
  return mesh;
}

/// Convex parts that cover a solid and reach at most about `tolerance` beyond it. They are the solid exactly where
/// doubles hold their corners and these parts are few; else the tolerance is the certified error of a decomposition.
Compound covering_parts(const MeshSolid& solid, double tolerance) {
  auto cut = SolidParts::from_solid(solid, {.tolerance = tolerance});
  if (cut) return cut->outer();
  if (cut.error().code != ErrorCode::limit_exceeded) {
    query::refuse(to_string(cut.error().code), cut.error().message, "");
  }
  if (tolerance == 0) {
    query::refuse("limit_exceeded",
                  cut.error().message +
                      "; tolerance=LENGTH allows parts that reach so far beyond it, and meshes=\"hull\" "
                      "takes the convex hull",
                  "");
  }
  DecompositionSettings settings;
  settings.error = tolerance;
  return decomposed(solid, settings);
}

/// The solid of a closed mesh as vertices of convex parts, one part where the mesh is convex.
py::list solid_parts(const std::string& path, py::handle scale, double tolerance) {
  py::list parts;
  try {
    query::MeshPoints mesh = scaled_mesh(path, scale);
    std::optional<Compound> cover;
    query::MeshBody body;
    {
      const Unlocked unlocked;
      body = query::body_of_mesh(std::move(mesh), path, {.hull_words = "meshes=\"hull\"", .parts_words = ""});
      if (body.solid) cover = covering_parts(*body.solid, tolerance);
    }
    if (!cover) {
      parts.append(vertices_of(*body.hull->shape.polytope()));
    } else {
      for (const Compound::Part& part : cover->parts()) parts.append(vertices_of(*part.shape.polytope()));
    }
  } catch (const query::Refusal& refusal) {
    refuse(refusal.code, refusal.message, path);
  }
  return parts;
}

/// Numbers in sets that grow together.
class Sets {
 public:
  explicit Sets(std::size_t count) : above_(count) { std::iota(above_.begin(), above_.end(), 0); }
  std::int32_t root(std::int32_t v) {
    while (up(v) != v) v = up(v) = up(up(v));
    return v;
  }
  void unite(std::int32_t v, std::int32_t w) { up(root(v)) = root(w); }

 private:
  std::int32_t& up(std::int32_t v) { return above_[static_cast<std::size_t>(v)]; }
  std::vector<std::int32_t> above_;
};

using Edges = std::map<std::pair<std::int32_t, std::int32_t>, int>;

/// The number of faces of each edge, its ends by the numbers that `name` gives them.
template <class Name>
Edges edges_of(const query::MeshPoints& mesh, Name&& name) {
  Edges edges;
  for (std::int64_t f = 0; f < mesh.faces.size(); ++f) {
    const auto begin = static_cast<std::size_t>(mesh.faces.offsets[static_cast<std::size_t>(f)]);
    const auto end = static_cast<std::size_t>(mesh.faces.offsets[static_cast<std::size_t>(f) + 1]);
    for (std::size_t c = begin; c < end; ++c) {
      const std::int32_t v = name(mesh.faces.corners[c]), w = name(mesh.faces.corners[c + 1 < end ? c + 1 : begin]);
      ++edges[std::minmax(v, w)];
    }
  }
  return edges;
}

/// @throws Refusal open_edge for an edge with an odd number of faces. @param same  the number of each vertex
void require_closed(const query::MeshPoints& mesh, const std::vector<std::int32_t>& same) {
  for (const auto& [edge, faces] : edges_of(mesh, [&](std::int32_t v) { return same[static_cast<std::size_t>(v)]; })) {
    if (faces % 2 == 0 || edge.first == edge.second) continue;
    const Vec3& x = mesh.points[static_cast<std::size_t>(edge.first)];
    const Vec3& y = mesh.points[static_cast<std::size_t>(edge.second)];
    const auto told = [](const Vec3& at) {
      return "(" + std::to_string(at[0]) + ", " + std::to_string(at[1]) + ", " + std::to_string(at[2]) + ")";
    };
    query::refuse("open_edge",
                  "the edge from " + told(x) + " to " + told(y) + " has " + std::to_string(faces) +
                      (faces == 1 ? " face" : " faces") +
                      ", so that a connected part has a hole there; mend the mesh, or take its hull (meshes=\"hull\")",
                  "");
  }
}

/// Sets of vertices that faces connect. Parts that are closed by the file's own numbers of vertices stay apart, even
/// where they touch, as those of a convex decomposition do. Others have their vertices repeated for each face, or along
/// seams, so that equal coordinates connect them.
Sets connected(const query::MeshPoints& mesh) {
  Sets sets(mesh.points.size());
  const Edges faces_of_edge = edges_of(mesh, [](std::int32_t v) { return v; });
  for (const auto& [edge, faces] : faces_of_edge) sets.unite(edge.first, edge.second);
  std::vector<bool> open(mesh.points.size(), false);
  for (const auto& [edge, faces] : faces_of_edge) {
    if (faces != 2) open[static_cast<std::size_t>(sets.root(edge.first))] = true;
  }
  std::vector<bool> joins(mesh.points.size(), false);
  for (const std::int32_t v : mesh.faces.corners) {
    joins[static_cast<std::size_t>(v)] = open[static_cast<std::size_t>(sets.root(v))];
  }
  std::map<std::array<double, 3>, std::int32_t> first;
  std::vector<std::int32_t> same(mesh.points.size());
  for (std::size_t v = 0; v < mesh.points.size(); ++v) {
    same[v] = static_cast<std::int32_t>(v);
    if (!joins[v]) continue;
    const Vec3& x = mesh.points[v];
    const auto number = static_cast<std::int32_t>(v);
    same[v] = first.try_emplace({x[0], x[1], x[2]}, number).first->second;
    sets.unite(number, same[v]);
  }
  require_closed(mesh, same);
  return sets;
}

/// The points of each connected part of a mesh, in the order of the parts' first faces.
py::list connected_parts(const std::string& path, py::handle scale) {
  py::list parts;
  try {
    const query::MeshPoints mesh = scaled_mesh(path, scale);
    Sets sets = connected(mesh);
    std::map<std::int32_t, std::size_t> number;
    std::vector<std::vector<Vec3>> members;
    std::vector<bool> taken(mesh.points.size(), false);
    for (const std::int32_t v : mesh.faces.corners) {
      if (taken[static_cast<std::size_t>(v)]) continue;
      taken[static_cast<std::size_t>(v)] = true;
      const auto [found, fresh] = number.try_emplace(sets.root(v), members.size());
      if (fresh) members.emplace_back();
      members[found->second].push_back(mesh.points[static_cast<std::size_t>(v)]);
    }
    for (const std::vector<Vec3>& part : members) {
      Array array({static_cast<py::ssize_t>(part.size()), py::ssize_t{3}});
      for (std::size_t i = 0; i < part.size(); ++i) {
        for (int k = 0; k < 3; ++k) array.mutable_at(static_cast<py::ssize_t>(i), k) = part[i][k];
      }
      parts.append(array);
    }
  } catch (const query::Refusal& refusal) {
    refuse(refusal.code, refusal.message, path);
  }
  return parts;
}

struct Input {
  explicit Input(int opened) : descriptor(opened) {}
  ~Input() {
    if (descriptor >= 0) ::close(descriptor);
  }
  Input(const Input&) = delete;
  Input& operator=(const Input&) = delete;
  int descriptor;
};

/// A record in a file, judged: the JSON answer of the protocol, and the table for people.
py::tuple audit(const std::string& path, double tolerance, int threads, std::size_t worst, const std::string& fail_on) {
  audit::AuditSettings settings;
  settings.threads = threads;
  settings.worst_kept = worst;
  if (tolerance > 0) settings.tolerance = tolerance;
  std::vector<audit::FailCondition> conditions;
  try {
    if (!fail_on.empty()) conditions = audit::parse_fail_conditions(fail_on);
  } catch (const query::Refusal& refusal) {
    constexpr std::string_view kFlag = "--fail-on: ";  // the command's name of it
    refuse(refusal.code, refusal.message.substr(refusal.message.starts_with(kFlag) ? kFlag.size() : 0), "fail_on");
  }
  const Input input{::open(path.c_str(), O_RDONLY | O_CLOEXEC)};
  if (input.descriptor < 0) refuse("unreadable_file", std::strerror(errno), path);
  audit::Audit result;
  {
    const Unlocked unlocked;
    Interrupts interrupts;
    const auto seen = [&](const auto&...) { interrupts.hear(); };
    audit::audit_record(input.descriptor, settings, seen, result);
  }
  if (result.end == audit::Audit::End::unreadable) refuse("unreadable_file", "cannot be read to its end", path);
  py::list refusals;
  for (const audit::RefusedLine& line : result.summary.refusals()) {
    refusals.append(py::make_tuple(line.line, line.refusal.code, line.refusal.message, line.refusal.where));
  }
  const auto outcomes = audit::check(conditions, result.summary);
  if (result.end == audit::Audit::End::no_record) return py::make_tuple("", "", refusals);
  try {
    return py::make_tuple(audit::audit_json(result, outcomes), audit::audit_table(result, outcomes, path, true),
                          refusals);
  } catch (const query::Refusal& refusal) {  // an error past the range of doubles
    refuse(refusal.code, refusal.message, "records");
  }
}

}  // namespace

}  // namespace pd::python

PYBIND11_MODULE(_protocol, module) {
  module.doc() = "The compiled part of pdepth that reads files and lines; use the package pdepth.";
  pd::python::use_refused(pybind11::module_::import("pdepth._core").attr("Refused"));
  module.def("answer", &pd::python::answer);
  module.def("answer_many", &pd::python::answer_many);
  module.def("mesh_points", &pd::python::mesh_points);
  module.def("solid_parts", &pd::python::solid_parts);
  module.def("mesh_parts", &pd::python::mesh_parts);
  module.def("connected_parts", &pd::python::connected_parts);
  module.def("audit", &pd::python::audit);
}
