#include "python/mesh_parts.hpp"

#include <pybind11/stl.h>

#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "mesh/mesh_file.hpp"
#include "pd/solid/convex_decomposition.hpp"
#include "protocol/solid_reader.hpp"
#include "python/rows.hpp"
#include "support/refusal.hpp"

namespace pd::python {

namespace {

query::MeshPoints read_arrays(const py::tuple& pair) {
  query::MeshPoints mesh;
  const Array points = read_array(pair[0], "mesh.vertices", {-1, 3});
  for (py::ssize_t i = 0; i < points.shape(0); ++i) {
    mesh.points.emplace_back(points.at(i, 0), points.at(i, 1), points.at(i, 2));
  }
  query::MeshFaces& faces = mesh.faces;
  for (const auto& face : pair[1].cast<std::vector<std::vector<std::int64_t>>>()) {
    for (const std::int64_t v : face) {
      if (v < 0 || v >= points.shape(0)) {
        refuse("out_of_range", "vertices are numbered 0 to " + std::to_string(points.shape(0) - 1),
               "mesh.faces[" + std::to_string(faces.size()) + "]");
      }
      faces.corners.push_back(static_cast<std::int32_t>(v));
    }
    faces.offsets.push_back(static_cast<std::int32_t>(faces.corners.size()));
  }
  return mesh;
}

Compound decomposed_mesh(query::MeshPoints mesh, const std::string& name, const query::SolidWish& wish,
                         DecompositionSettings& settings) {
  const auto solid = query::body_of_mesh(std::move(mesh), name, wish).solid;
  if (!solid) query::refuse("bad_faces", "the mesh has points and no faces, so that it bounds no solid", "");
  return decomposed(*solid, settings);
}

}  // namespace

query::MeshPoints read_mesh(py::handle mesh) {
  if (py::isinstance<py::tuple>(mesh)) return read_arrays(mesh.cast<py::tuple>());
  const query::Limits limits;
  return query::read_mesh_points(mesh.cast<std::string>(), limits.max_vertices, query::kMaxMeshBytes);
}

Compound decomposed(const MeshSolid& solid, DecompositionSettings& settings) {
  Interrupts interrupts;
  settings.watch = [&](const auto&) { interrupts.hear(); };
  auto found = decompose(solid, settings);
  if (!found) query::refuse(to_string(found.error().code), found.error().message, "");
  if (!found->error_reached) {
    query::refuse("limit_exceeded",
                  "the parts are certified to " + std::to_string(found->error) + " and not to the error asked, after " +
                      std::to_string(found->steps) + " steps; a larger error takes fewer",
                  "");
  }
  settings.error = found->error;
  return std::move(found->parts);
}

py::tuple mesh_parts(py::handle mesh, py::handle error, const std::string& side, bool turn_faces) {
  DecompositionSettings settings;
  settings.inside = side == "inner";
  if (!error.is_none()) {
    settings.error = *read_array(error, "error", {}).data();
    if (!(settings.error > 0 && settings.error <= std::numeric_limits<double>::max())) {
      refuse("bad_value", "must be finite and greater than 0", "error");
    }
  }
  const std::string name = py::isinstance<py::tuple>(mesh) ? "mesh" : mesh.cast<std::string>();
  try {
    query::MeshPoints source = read_mesh(mesh);
    const query::SolidWish wish{.always = !error.is_none(),
                                .turn_faces = turn_faces,
                                .hull_words = "ConvexPolytope.from_mesh(..., hull=True)",
                                .turn_words = "turn_faces=True"};
    Compound parts = [&] {
      const Unlocked unlocked;
      return error.is_none() ? query::parts_of_mesh(source, name, wish).compound
                             : decomposed_mesh(std::move(source), name, wish, settings);
    }();
    py::list arrays;
    for (const Compound::Part& part : parts.parts()) {
      const ConvexPolytope& polytope = *part.shape.polytope();
      Array points({static_cast<py::ssize_t>(polytope.num_vertices()), py::ssize_t{3}});
      for (int v = 0; v < polytope.num_vertices(); ++v) {
        for (int k = 0; k < 3; ++k) points.mutable_at(v, k) = polytope.vertex(v)[k];
      }
      arrays.append(points);
    }
    return py::make_tuple(arrays, error.is_none() ? py::object(py::none()) : py::float_(settings.error));
  } catch (const query::Refusal& refusal) {
    // The name begins what a fault of the mesh says already.
    const std::string front = name + ": ";
    refuse(refusal.code, refusal.message.starts_with(front) ? refusal.message.substr(front.size()) : refusal.message,
           name);
  }
}

}  // namespace pd::python
