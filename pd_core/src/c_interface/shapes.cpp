/// @file
/// Shapes of `pdepth.h`: the core's factories.

#include <algorithm>
#include <span>
#include <string>
#include <vector>

#include "c_interface/answers.hpp"
#include "c_interface/handles.hpp"
#include "c_interface/reading.hpp"
#include "pd/shape/halfspaces.hpp"

namespace pd::c_interface {

namespace {

constexpr std::int64_t kMostRows = 300'000'000;

void require_count(std::int64_t count, const char* argument) {
  if (count < 0) refuse(PDEPTH_BAD_VALUE, "must be 0 or more, not " + std::to_string(count), argument);
  if (count > kMostRows) refuse(PDEPTH_LIMIT_EXCEEDED, "at most 3e8", argument);
}

/// [count x width] numbers.
std::span<const double> read_rows(const double* numbers, std::int64_t count, int width, const char* argument,
                                  const char* count_name = "count") {
  require_count(count, count_name);
  if (count > 0) given(numbers, argument);
  return {numbers, static_cast<std::size_t>(count) * static_cast<std::size_t>(width)};
}

std::vector<Vec3> read_points(const double* numbers, std::int64_t count, const char* argument = "points",
                              const char* count_name = "count") {
  const std::span<const double> rows = read_rows(numbers, count, 3, argument, count_name);
  std::vector<Vec3> points;
  points.reserve(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < rows.size(); i += 3) points.emplace_back(rows[i], rows[i + 1], rows[i + 2]);
  return points;
}

/// The core calls points of a polytope or a mesh its vertices, and numbers of points in faces its corners.
/// @param argument  the struct that the caller's arrays stand in, or empty.
template <class Body>
Body callers_words(Expected<Body>&& made, std::string_view argument) {
  if (made) return std::move(made).value();
  Error error = made.error();
  const auto rename = [&](std::string_view word, std::string_view callers) {
    if (!error.where.starts_with(word)) return false;
    error.where.replace(0, word.size(), callers);
    return true;
  };
  if (!rename("vertices", "points")) rename("corners", "vertices");
  // `faces[3]` is a face of the struct `faces`.
  refuse(error, error.where.starts_with("faces") && argument == "faces" ? "" : argument);
}

/// The loops of a `pdepth_faces`, which stay in the caller's memory.
struct ReadFaces {
  std::vector<Vec3> points;
  std::span<const std::int32_t> offsets, corners;

  ReadFaces(const pdepth_faces* faces, const std::string& argument) {
    const pdepth_faces& read = read_struct(faces, argument.c_str());
    require_unused(read.reserved, argument.c_str());
    require_count(read.num_faces, (argument + ".num_faces").c_str());
    points =
        read_points(read.points, read.num_points, (argument + ".points").c_str(), (argument + ".num_points").c_str());
    offsets = {&given(read.offsets, (argument + ".offsets").c_str()), static_cast<std::size_t>(read.num_faces) + 1};
    if (offsets.front() != 0 || !std::is_sorted(offsets.begin(), offsets.end())) {
      refuse(PDEPTH_BAD_FACES, "offsets rise from 0 to the number of corners", argument + ".offsets");
    }
    corners = {&given(read.vertices, (argument + ".vertices").c_str()), static_cast<std::size_t>(offsets.back())};
  }
};

/// Makes a convex shape at the border.
template <class Make>
pdepth_status make_convex(pdepth_context* context, pdepth_shape** shape, Make&& make) {
  return at_border(context, [&] {
    given(shape, "shape");
    *shape = new pdepth_shape(Compound(ConvexShape(make())), true);
  });
}

using RoundFactory = Expected<ConvexShape> (*)(double radius, double half_height, int axis);

pdepth_status make_round(pdepth_context* context, pdepth_shape** shape, RoundFactory factory, const double (&sizes)[2],
                         std::int32_t axis) {
  return make_convex(context, shape, [&] { return value_of(factory(sizes[0], sizes[1], axis), ""); });
}

const Compound::Part& part_of(const pdepth_shape& shape, std::int32_t part, const char* argument) {
  const std::vector<Compound::Part>& parts = shape.drawn("shape").parts();
  if (part < 0 || static_cast<std::size_t>(part) >= parts.size()) {
    refuse(PDEPTH_OUT_OF_RANGE, "the shape has the parts 0 to " + std::to_string(parts.size() - 1), argument);
  }
  return parts[static_cast<std::size_t>(part)];
}

const MeshSolid& mesh_of(const pdepth_shape& shape) {
  if (!shape.solid) refuse(PDEPTH_OUT_OF_RANGE, "PDEPTH_PART_MESH is for solids alone", "part");
  return shape.solid->mesh();
}

void write_mesh(const MeshSolid& mesh, const pdepth_surface& room) {
  double* point = room.points;
  for (std::size_t v = 0; point != nullptr && v < mesh.vertices().size(); ++v, point += 3) {
    write_vector(mesh.vertices()[v], point);
  }
  for (std::size_t t = 0; t < mesh.triangles().size(); ++t) {
    if (room.offsets != nullptr) room.offsets[t] = static_cast<std::int32_t>(3 * t);
    if (room.corners != nullptr) std::ranges::copy(mesh.triangles()[t].vertices, room.corners + 3 * t);
  }
  if (room.offsets != nullptr) {
    room.offsets[mesh.triangles().size()] = static_cast<std::int32_t>(3 * mesh.triangles().size());
  }
}

/// The points of a face of the caller's mesh, each once, in rising order.
std::vector<std::int32_t> corners_of_face(const MeshSolid& mesh, std::int32_t face) {
  std::vector<std::int32_t> corners;
  for (const MeshSolid::Triangle& triangle : mesh.triangles()) {
    if (triangle.face == face) corners.insert(corners.end(), triangle.vertices.begin(), triangle.vertices.end());
  }
  if (corners.empty()) refuse(PDEPTH_OUT_OF_RANGE, "the mesh has no such face", "feature.first");
  std::sort(corners.begin(), corners.end());
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  return corners;
}

void require_below(std::int32_t number, int count, const char* argument) {
  if (number >= 0 && number < count) return;
  refuse(PDEPTH_OUT_OF_RANGE, "must lie in 0 to " + std::to_string(count - 1), argument);
}

/// The vertices of a feature in the numbers of the core.
void for_each_vertex(const ConvexPolytope& body, const pdepth_feature& feature, auto&& visit) {
  switch (feature.kind) {
    case PDEPTH_FEATURE_EDGE:
      require_below(feature.second, body.num_vertices(), "feature.second");
      [[fallthrough]];
    case PDEPTH_FEATURE_VERTEX:
      require_below(feature.first, body.num_vertices(), "feature.first");
      visit(feature.first);
      if (feature.kind == PDEPTH_FEATURE_EDGE) visit(feature.second);
      return;
    case PDEPTH_FEATURE_FACET:
      require_below(feature.first, body.num_facets(), "feature.first");
      for (const std::int32_t vertex : body.facet_vertices(feature.first)) visit(vertex);
      return;
    default:
      refuse(PDEPTH_BAD_VALUE, "must be one of PDEPTH_FEATURE_...", "feature.kind");
  }
}

}  // namespace

}  // namespace pd::c_interface

using namespace pd;               // NOLINT(google-build-using-namespace): the functions of C stand in no namespace
using namespace pd::c_interface;  // NOLINT(google-build-using-namespace)

pdepth_status pdepth_box(pdepth_context* context, const double half_extents[3], pdepth_shape** shape) {
  return make_convex(context, shape, [&] {
    const double* const h = &given(half_extents, "half_extents");
    return value_of(ConvexPolytope::box({h[0], h[1], h[2]}), "");
  });
}

pdepth_status pdepth_sphere(pdepth_context* context, double radius, pdepth_shape** shape) {
  return make_convex(context, shape, [&] { return value_of(ConvexShape::sphere(radius), ""); });
}

pdepth_status pdepth_ellipsoid(pdepth_context* context, const double radii[3], pdepth_shape** shape) {
  return make_convex(context, shape, [&] {
    const double* const r = &given(radii, "radii");
    return value_of(ConvexShape::ellipsoid({r[0], r[1], r[2]}), "");
  });
}

pdepth_status pdepth_capsule(pdepth_context* context, double radius, double half_height, int32_t axis,
                             pdepth_shape** shape) {
  return make_round(context, shape, &ConvexShape::capsule, {radius, half_height}, axis);
}

pdepth_status pdepth_cylinder(pdepth_context* context, double radius, double half_height, int32_t axis,
                              pdepth_shape** shape) {
  return make_round(context, shape, &ConvexShape::cylinder, {radius, half_height}, axis);
}

pdepth_status pdepth_cone(pdepth_context* context, double radius, double half_height, int32_t axis,
                          pdepth_shape** shape) {
  return make_round(context, shape, &ConvexShape::cone, {radius, half_height}, axis);
}

pdepth_status pdepth_convex_hull(pdepth_context* context, const double* points, int64_t count, pdepth_shape** shape) {
  return make_convex(context, shape,
                     [&] { return callers_words(ConvexPolytope::from_points(read_points(points, count)), ""); });
}

pdepth_status pdepth_convex_faces(pdepth_context* context, const pdepth_faces* faces, pdepth_shape** shape) {
  return make_convex(context, shape, [&] {
    const ReadFaces read(faces, "faces");
    return callers_words(ConvexPolytope::from_faces(read.points, read.offsets, read.corners), "faces");
  });
}

pdepth_status pdepth_mesh_solid(pdepth_context* context, const pdepth_faces* mesh, int32_t turn_faces,
                                pdepth_shape** shape) {
  return at_border(context, [&] {
    if (!kHasCompounds) refuse(PDEPTH_UNSUPPORTED, "the module for convex bodies makes no solids", "mesh");
    given(shape, "shape");
    const ReadFaces read(mesh, "mesh");
    *shape = new pdepth_shape(
        callers_words(MeshSolid::from_faces({read.points, read.offsets, read.corners}, {.turn_faces = turn_faces != 0}),
                      "mesh"),
        context->source);
  });
}

pdepth_status pdepth_halfspaces(pdepth_context* context, const double* planes, int64_t count, pdepth_shape** shape) {
  return make_convex(context, shape, [&] {
    const std::span<const double> rows = read_rows(planes, count, 4, "planes");
    std::vector<Halfspace3> read;
    for (std::size_t i = 0; i < rows.size(); i += 4) read.push_back({{rows[i], rows[i + 1], rows[i + 2]}, rows[i + 3]});
    return value_of(polytope_of_halfspaces(read), "");
  });
}

pdepth_status pdepth_hull_of_spheres(pdepth_context* context, const double* spheres, int64_t count,
                                     pdepth_shape** shape) {
  return make_convex(context, shape, [&] {
    const std::span<const double> rows = read_rows(spheres, count, 4, "spheres");
    std::vector<Sphere> read;
    for (std::size_t i = 0; i < rows.size(); i += 4) read.push_back({{rows[i], rows[i + 1], rows[i + 2]}, rows[i + 3]});
    return value_of(ConvexShape::hull_of_spheres(read), "");
  });
}

pdepth_status pdepth_with_margin(pdepth_context* context, const pdepth_shape* body, double margin,
                                 pdepth_shape** shape) {
  return at_border(context, [&] {
    const pdepth_shape& from = given(body, "body");
    given(shape, "shape");
    *shape = new pdepth_shape(value_of(from.whole("body").with_margin(margin), ""), from.is_convex);
  });
}

pdepth_status pdepth_compound(pdepth_context* context, const pdepth_part* parts, int64_t count, pdepth_shape** shape) {
  return at_border(context, [&] {
    if (!kHasCompounds) refuse(PDEPTH_UNSUPPORTED, "the module for convex bodies makes no compounds", "parts");
    require_count(count, "count");
    given(shape, "shape");
    std::vector<Compound::Placed> placed;
    for (std::int64_t i = 0; i < count; ++i) {
      const pdepth_part& part = (&given(parts, "parts"))[i];
      const std::string where = "parts[" + std::to_string(i) + "]";
      const std::string shape_name = where + ".shape";
      placed.push_back({given(part.shape, shape_name.c_str()).whole(shape_name.c_str()),
                        read_pose(part.pose, (where + ".pose").c_str())});
    }
    *shape = new pdepth_shape(value_of(Compound::from_compounds(placed), ""), false);
  });
}

pdepth_status pdepth_shape_describe(pdepth_context* context, const pdepth_shape* shape, int32_t part,
                                    pdepth_shape_info* info) {
  return at_border(context, [&] {
    const pdepth_shape& body = given(shape, "shape");
    pdepth_shape_info& out = answer_struct(info, "info");
    pdepth_shape_info found{};
    found.is_convex = body.is_convex ? 1 : 0;
    found.dimension = 3;
    if (part == PDEPTH_PART_MESH) {
      const MeshSolid& mesh = mesh_of(body);
      found.vertices = static_cast<std::int32_t>(mesh.vertices().size());
      found.facets = static_cast<std::int32_t>(mesh.triangles().size());
      write_answer(found, out);
      return;
    }
    const ConvexShape& core = part_of(body, part, "part").shape;
    found.parts = static_cast<std::int32_t>(body.drawn("shape").parts().size());
    found.margin = core.margin();
    if (const ConvexPolytope* const polytope = core.polytope()) {
      found.dimension = polytope->affine_dimension();
      found.vertices = polytope->num_vertices();
      found.facets = polytope->num_facets();
    }
    write_answer(found, out);
  });
}

pdepth_status pdepth_shape_surface(pdepth_context* context, const pdepth_shape* shape, int32_t part,
                                   const pdepth_surface* surface) {
  return at_border(context, [&] {
    const pdepth_surface& room = read_struct(surface, "surface");
    require_unused(room.reserved, "surface");
    if (part == PDEPTH_PART_MESH) {
      write_mesh(mesh_of(given(shape, "shape")), room);
      return;
    }
    const Compound::Part& asked = part_of(given(shape, "shape"), part, "part");
    const ConvexPolytope* const polytope = asked.shape.polytope();
    if (polytope == nullptr) refuse(PDEPTH_UNSUPPORTED, "a curved core has no facets", "part");
    for (int v = 0; room.points != nullptr && v < polytope->num_vertices(); ++v) {
      const Vec3 point = asked.pose.rotation() * polytope->vertex(v) + asked.pose.translation();
      write_vector(point, room.points + 3 * static_cast<std::ptrdiff_t>(v));
    }
    std::int32_t corners = 0;
    for (int f = 0; f < polytope->num_facets(); ++f) {
      if (room.offsets != nullptr) room.offsets[f] = corners;
      for (const std::int32_t vertex : polytope->facet_vertices(f)) {
        if (room.corners != nullptr) room.corners[corners] = vertex;
        ++corners;
      }
    }
    if (room.offsets != nullptr) room.offsets[polytope->num_facets()] = corners;
  });
}

pdepth_status pdepth_feature_points(pdepth_context* context, const pdepth_shape* shape, const pdepth_feature* feature,
                                    int32_t* points, int32_t* count) {
  return at_border(context, [&] {
    const pdepth_feature& asked = given(feature, "feature");
    const std::int32_t room = given(count, "count");
    if (room < 0) refuse(PDEPTH_BAD_VALUE, "must be the room in `points`, 0 or more", "count");
    if (room > 0) given(points, "points");
    std::int32_t found = 0;
    if (asked.part == PDEPTH_PART_MESH && asked.kind != PDEPTH_FEATURE_NONE) {
      if (asked.kind != PDEPTH_FEATURE_FACET) refuse(PDEPTH_OUT_OF_RANGE, "a mesh has facets alone", "feature.kind");
      for (const std::int32_t vertex : corners_of_face(mesh_of(given(shape, "shape")), asked.first)) {
        if (found < room) points[found] = vertex;
        ++found;
      }
    } else if (asked.kind != PDEPTH_FEATURE_NONE) {
      const ConvexShape& core = part_of(given(shape, "shape"), asked.part, "feature.part").shape;
      const ConvexPolytope* const polytope = core.polytope();
      if (polytope == nullptr) refuse(PDEPTH_OUT_OF_RANGE, "a curved core has no features", "feature.kind");
      for_each_vertex(*polytope, asked, [&](std::int32_t vertex) {
        if (found < room) points[found] = polytope->caller_id(vertex);
        ++found;
      });
    }
    *count = found;
  });
}
