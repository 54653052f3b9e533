#include "python/body.hpp"

#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <functional>
#include <map>

#include "pd/shape/halfspaces.hpp"
#include "pd/shape/star_body.hpp"
#include "python/pose_argument.hpp"

namespace pd::python {

namespace {

using Make = std::function<BodyRef(const py::tuple&)>;

BodyRef make(std::variant<ConvexShape, Compound> value) { return std::make_shared<Body>(Body{std::move(value)}); }

BodyRef make_faces(const py::tuple& numbers) {
  const std::vector<Vec3> points = read_points(numbers[0], "vertices");
  std::vector<std::int32_t> offsets{0}, corners;
  for (const auto& face : read_faces(numbers[1], points.size())) {
    corners.insert(corners.end(), face.begin(), face.end());
    offsets.push_back(static_cast<std::int32_t>(corners.size()));
  }
  auto polytope = ConvexPolytope::from_faces(points, offsets, corners);
  if (!polytope) refuse(to_string(polytope.error().code), polytope.error().message, polytope.error().where);
  return make(ConvexShape(*polytope));
}

BodyRef make_halfspaces(const py::tuple& numbers) {
  const Array array = read_array(numbers[0], "planes", {-1, 4});
  std::vector<Halfspace3> planes;
  for (py::ssize_t i = 0; i < array.shape(0); ++i) {
    planes.push_back({{array.at(i, 0), array.at(i, 1), array.at(i, 2)}, array.at(i, 3)});
  }
  return make(ConvexShape(value_of(polytope_of_halfspaces(planes), "planes")));
}

BodyRef make_star(const py::tuple& numbers) {
  const std::vector<Vec3> points = read_points(numbers[0], "vertices");
  std::vector<StarBody::Triangle> triangles;
  for (const auto& face : read_faces(numbers[1], points.size())) {
    if (face.size() != 3) {
      refuse("bad_faces", "a face has three corners", "faces[" + std::to_string(triangles.size()) + "]");
    }
    triangles.push_back({face[0], face[1], face[2]});
  }
  auto star = StarBody::from_faces(points, triangles, read_vector(numbers[2], "center"));
  if (!star) refuse(to_string(star.error().code), star.error().message, star.error().where);
  return make(star->tetrahedra());
}

BodyRef make_compound(const py::tuple& numbers) {
  std::vector<Compound::Placed> parts;
  for (const py::handle part : numbers[0]) {
    const auto pair = py::cast<py::tuple>(part);
    const std::string where = "parts[" + std::to_string(parts.size()) + "]";
    if (!py::isinstance<Body>(pair[0])) refuse("bad_value", "a part is a shape, or (shape, pose)", where);
    parts.push_back({py::cast<BodyRef>(pair[0])->compound(), read_pose(pair[1], where + ".pose")});
  }
  return make(value_of(Compound::from_compounds(parts), "parts"));
}

double number_of(py::handle value, std::string_view argument) {
  const Array array = read_array(value, argument, {});
  return *array.data();
}

BodyRef make_curved(const py::tuple& n, Expected<ConvexShape> (*factory)(double radius, double half_height, int axis)) {
  const double radius = number_of(n[0], "radius"), half_height = number_of(n[1], "half_height");
  auto shape = factory(radius, half_height, n[2].cast<int>());
  if (!shape) refuse(to_string(shape.error().code), shape.error().message, shape.error().where);
  return make(*shape);
}

const std::map<std::string, Make>& makers() {
  static const std::map<std::string, Make> table = {
      {"points",
       [](const py::tuple& n) {
         const std::vector<Vec3> points = read_points(n[0], "points");
         const Unlocked unlocked;
         return make(ConvexShape(value_of(ConvexPolytope::from_points(points), "points")));
       }},
      {"faces", make_faces},
      {"halfspaces", make_halfspaces},
      {"box",
       [](const py::tuple& n) {
         const Array h = read_array(n[0], "half_extents", {3});
         return make(ConvexShape(value_of(ConvexPolytope::box({h.at(0), h.at(1), h.at(2)}), "half_extents")));
       }},
      {"sphere",
       [](const py::tuple& n) { return make(value_of(ConvexShape::sphere(number_of(n[0], "radius")), "radius")); }},
      {"ellipsoid",
       [](const py::tuple& n) {
         const Array r = read_array(n[0], "radii", {3});
         return make(value_of(ConvexShape::ellipsoid({r.at(0), r.at(1), r.at(2)}), "radii"));
       }},
      {"sphere_hull",
       [](const py::tuple& n) {
         const Array rows = read_array(n[0], "spheres", {-1, 4});
         std::vector<Sphere> spheres;
         for (py::ssize_t i = 0; i < rows.shape(0); ++i) {
           spheres.push_back({{rows.at(i, 0), rows.at(i, 1), rows.at(i, 2)}, rows.at(i, 3)});
         }
         auto hull = ConvexShape::hull_of_spheres(spheres);
         if (!hull) refuse(to_string(hull.error().code), hull.error().message, hull.error().where);
         return make(*hull);
       }},
      {"capsule", [](const py::tuple& n) { return make_curved(n, ConvexShape::capsule); }},
      {"cylinder", [](const py::tuple& n) { return make_curved(n, ConvexShape::cylinder); }},
      {"cone", [](const py::tuple& n) { return make_curved(n, ConvexShape::cone); }},
      {"compound", make_compound},
      {"star", make_star},
  };
  return table;
}

BodyRef make_body(const std::string& kind, const py::tuple& numbers, py::handle margin_value) {
  const BodyRef body = makers().at(kind)(numbers);
  const double margin = number_of(margin_value, "margin");
  if (margin == 0) return body;
  return std::visit([&](const auto& shape) { return make(value_of(shape.with_margin(margin), "margin")); },
                    body->value);
}

const ConvexPolytope& polytope_of(const Body& body) {
  const ConvexPolytope* const polytope = body.convex() == nullptr ? nullptr : body.convex()->polytope();
  if (polytope == nullptr) refuse("unsupported", "only a shape with a polytope core has vertices and facets", "shape");
  return *polytope;
}

Array vertices_of(const Body& body) {
  const ConvexPolytope& polytope = polytope_of(body);
  Array array({static_cast<py::ssize_t>(polytope.num_vertices()), py::ssize_t{3}});
  for (int v = 0; v < polytope.num_vertices(); ++v) {
    for (int k = 0; k < 3; ++k) array.mutable_at(v, k) = polytope.vertex(v)[k];
  }
  return array;
}

py::list facets_of(const Body& body) {
  const ConvexPolytope& polytope = polytope_of(body);
  py::list facets;
  for (int f = 0; f < polytope.num_facets(); ++f) {
    py::list loop;
    for (const std::int32_t v : polytope.facet_vertices(f)) loop.append(polytope.caller_id(v));
    facets.append(loop);
  }
  return facets;
}

}  // namespace

std::vector<Vec3> read_points(py::handle value, std::string_view argument) {
  const Array array = read_array(value, argument, {-1, 3});
  std::vector<Vec3> points(static_cast<std::size_t>(array.shape(0)));
  for (std::size_t i = 0; i < points.size(); ++i) points[i] = Eigen::Map<const Vec3>(array.data() + 3 * i);
  return points;
}

std::vector<std::vector<std::int32_t>> read_faces(py::handle value, std::size_t num_points) {
  const auto count = static_cast<long long>(std::clamp<std::size_t>(num_points, 1, INT32_MAX));
  std::vector<std::vector<std::int32_t>> faces;
  for (const py::handle face : value) {
    faces.emplace_back();
    for (const py::handle index : face) {
      int overflow = 0;
      const long long number = PyLong_AsLongLongAndOverflow(index.ptr(), &overflow);
      if (PyErr_Occurred() != nullptr) throw py::error_already_set();
      if (overflow != 0 || number < 0 || number >= count) {
        refuse("bad_faces",
               "vertex index " + py::str(index).cast<std::string>() + " is outside 0.." + std::to_string(count - 1),
               "faces[" + std::to_string(faces.size() - 1) + "]");
      }
      faces.back().push_back(static_cast<std::int32_t>(number));
    }
  }
  return faces;
}

Compound Body::compound() const {
  if (const ConvexShape* const shape = convex()) return Compound(*shape);
  return std::get<Compound>(value);
}

std::vector<int> feature_ids(const Body& body, int part, const Feature& feature) {
  const ConvexShape& shape = body.convex() != nullptr
                                 ? *body.convex()
                                 : std::get<Compound>(body.value).parts()[static_cast<std::size_t>(part)].shape;
  const ConvexPolytope* const polytope = shape.polytope();
  if (polytope == nullptr) return {};
  switch (feature.kind) {
    case Feature::Kind::vertex:
      return {polytope->caller_id(feature.first)};
    case Feature::Kind::edge:
      return {polytope->caller_id(feature.first), polytope->caller_id(feature.second)};
    case Feature::Kind::facet: {
      std::vector<int> ids;
      for (const std::int32_t v : polytope->facet_vertices(feature.first)) ids.push_back(polytope->caller_id(v));
      return ids;
    }
    case Feature::Kind::none:
      break;
  }
  return {};
}

void bind_shapes(py::module_& module) {
  // Python's shapes have arguments of their own: help() would show these for theirs.
  py::options options;
  options.disable_function_signatures();
  py::class_<Body, BodyRef> shape(module, "Shape", py::dynamic_attr(), "A body in a frame of its own. Immutable.");
  require_made(shape);
  shape
      .def(py::init(&make_body), py::arg("kind"), py::arg("numbers"), py::arg("margin"),
           "Arguments and errors: see the class.")
      .def_property_readonly("vertices", &vertices_of,
                             "[n, 3] float64: the hull's vertices in lexicographic order, in the shape's frame.")
      .def_property_readonly("facets", &facets_of,
                             "Lists of row numbers of the points that the shape was made from, counter-clockwise seen "
                             "from outside.")
      .def_property_readonly(
          "is_convex", [](const Body& body) { return body.convex() != nullptr; },
          "Whether the shape is one convex body, not a union of parts.");
}

}  // namespace pd::python
