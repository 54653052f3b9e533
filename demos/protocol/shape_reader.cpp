#include "protocol/shape_reader.hpp"

#include <array>
#include <cmath>
#include <memory>
#include <utility>

#include "pd/shape/halfspaces.hpp"
#include "protocol/line/line_notes.hpp"

namespace pd::query {

namespace {

int read_axis(const Node& node) {
  const std::string word = read_string(node);
  if (word == "x") return 0;
  if (word == "y") return 1;
  if (word == "z") return 2;
  node.refuse("bad_value", "must be \"x\", \"y\" or \"z\"");
}

void require_positive(double value, const Node& node) {
  if (value <= 0) node.refuse("bad_value", "a size must be greater than 0");
}

double read_size(const Node& node) {
  const double value = read_number(node);
  require_positive(value, node);
  return value;
}

struct FaceList {
  std::vector<std::int32_t> offsets{0};
  std::vector<std::int32_t> vertices;
};

/// Face loops with indices in [0, num_points); the shape of the surface is the hull builder's to judge.
FaceList read_faces(const Node& node, std::size_t num_points, const Limits& limits) {
  require_array(node, "an array of faces [i,j,k,...]");
  FaceList faces;
  for (std::size_t f = 0; f < node.size(); ++f) {
    const Node face = node.element(f);
    require_array(face, "a face [i,j,k,...]");
    for (std::size_t k = 0; k < face.size(); ++k) {
      const Node corner = face.element(k);
      const double index = read_number(corner);
      if (std::floor(index) != index) corner.refuse("bad_value", "a vertex index must be a whole number");
      if (index < 0 || index >= static_cast<double>(num_points)) {
        face.refuse("bad_faces", "a vertex index lies outside [0, " + std::to_string(num_points) + ")");
      }
      faces.vertices.push_back(static_cast<std::int32_t>(index));
    }
    // A closed surface with n vertices has fewer than 6 n corners.
    if (faces.vertices.size() > static_cast<std::size_t>(limits.max_vertices) * 6) {
      node.refuse("limit_exceeded", "more face corners than a surface with --max-vertices vertices can have");
    }
    faces.offsets.push_back(static_cast<std::int32_t>(faces.vertices.size()));
  }
  return faces;
}

NamedShape read_convex(const Node& node, const Limits& limits) {
  allow_only(node, {"type", "margin", "vertices", "faces"});
  const std::vector<Vec3> points = read_points(node.at("vertices"), limits.max_vertices);
  if (const auto faces_node = node.find("faces")) {
    const FaceList faces = read_faces(*faces_node, points.size(), limits);
    return {value_or_refuse(ConvexPolytope::from_faces(points, faces.offsets, faces.vertices), node), {}};
  }
  return {value_or_refuse(ConvexPolytope::from_points(points), node), {}};
}

NamedShape read_box(const Node& node) {
  allow_only(node, {"type", "margin", "half_extents"});
  const Node extents = node.at("half_extents");
  // What is no number at all in a size is a bad extent, and so is "nan" or "inf".
  if (extents.json().is_array()) {
    for (std::size_t i = 0; i < extents.size(); ++i) {
      const Node extent = extents.element(i);
      if (extent.json().is_string()) extent.refuse("bad_value", "a half extent must be a finite number greater than 0");
    }
  }
  return {value_or_refuse(ConvexPolytope::box(read_vector(extents)), node), {}};
}

ConvexShape read_about_axis(const Node& node, Expected<ConvexShape> (*make)(double, double, int)) {
  allow_only(node, {"type", "margin", "radius", "half_height", "axis"});
  const double radius = read_size(node.at("radius"));
  // A capsule without a height is a ball, as the library has it.
  const Node height = node.at("half_height");
  const double half_height = make == &ConvexShape::capsule ? read_number(height) : read_size(height);
  return value_or_refuse(make(radius, half_height, read_axis(node.at("axis"))), node);
}

/// A row [nx,ny,nz,offset] a plane.
NamedShape read_halfspaces(const Node& node, const Limits& limits) {
  allow_only(node, {"type", "margin", "planes"});
  const Node rows = node.at("planes");
  require_array(rows, "an array of halfspaces [nx,ny,nz,offset]");
  if (rows.size() > static_cast<std::size_t>(limits.max_vertices)) {
    rows.refuse("limit_exceeded", std::to_string(rows.size()) + " halfspaces; the limit is " +
                                      std::to_string(limits.max_vertices) + " (--max-vertices)");
  }
  std::vector<Halfspace3> planes;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::vector<double> n = read_numbers(rows.element(i), 4);
    planes.push_back({{n[0], n[1], n[2]}, n[3]});
  }
  return {value_or_refuse(polytope_of_halfspaces(planes), node), {}};
}

/// A row [x,y,z,radius] a sphere.
NamedShape read_sphere_hull(const Node& node, const Limits& limits) {
  allow_only(node, {"type", "margin", "spheres"});
  const Node rows = node.at("spheres");
  require_array(rows, "an array of spheres [x,y,z,radius]");
  if (rows.size() > static_cast<std::size_t>(limits.max_vertices)) {
    rows.refuse("limit_exceeded", std::to_string(rows.size()) + " spheres; the limit is " +
                                      std::to_string(limits.max_vertices) + " (--max-vertices)");
  }
  std::vector<Sphere> spheres;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::vector<double> s = read_numbers(rows.element(i), 4);
    spheres.push_back({{s[0], s[1], s[2]}, s[3]});
  }
  return {value_or_refuse(ConvexShape::hull_of_spheres(spheres), node), {}};
}

NamedShape read_mesh(const Node& node, const Limits& limits) {
  allow_only(node, {"type", "margin", "path", "as", "turn_faces"});
  const Node path = node.at("path");
  const auto as = node.find("as");
  const std::string word = as ? read_string(*as) : "";
  if (as && word == "solid") {
    as->refuse(
        "unsupported",
        "this query is for convex shapes; for solids there are depth, distance, intersect and, where their convex "
        "parts have exact corners, the queries of compounds");
  }
  if (as && word == "parts") {
    as->refuse(
        "unsupported",
        "this query is for convex shapes; for a mesh as a compound of its parts there are the queries of compounds");
  }
  if (as && word == "sheet") {
    as->refuse("unsupported", "a sheet has no inside: contact_manifold alone takes one, as its \"a\" or \"b\"");
  }
  if (as && word != "hull") as->refuse("bad_value", kMeshWords);
  const std::string file = read_string(path);
  if (!limits.files) path.refuse("unreadable_file", "files are not read here (--no-files)");
  const std::string key = mesh_key(word, read_flag(node, "turn_faces"), file);
  LineNotes nothing;
  MeshBody& body = (node.notes() != nullptr ? *node.notes() : nothing).meshes[key];
  try {
    if (!body.hull) {
      body.hull = std::make_shared<const NamedShape>(load_mesh_shape(file, limits, as ? MeshAs::hull : MeshAs::found));
    }
    if (const auto& note = body.hull->hull_note) node.remark("hull", note->left_out);
    return *body.hull;
  } catch (const Refusal& refusal) {
    path.refuse(refusal.code, refusal.message);
  }
}

NamedShape read_core(const Node& node, const Limits& limits) {
  const Node type_node = node.at("type");
  const std::string type = read_string(type_node);
  if (type == "convex") return read_convex(node, limits);
  if (type == "box") return read_box(node);
  if (type == "sphere") {
    allow_only(node, {"type", "margin", "radius"});
    return {value_or_refuse(ConvexShape::sphere(read_size(node.at("radius"))), node), {}};
  }
  if (type == "ellipsoid") {
    allow_only(node, {"type", "margin", "radii"});
    const Node radii = node.at("radii");
    const Vec3 lengths = read_vector(radii);
    for (std::size_t i = 0; i < 3; ++i) require_positive(lengths[static_cast<int>(i)], radii.element(i));
    return {value_or_refuse(ConvexShape::ellipsoid(lengths), node), {}};
  }
  if (type == "capsule") return {read_about_axis(node, &ConvexShape::capsule), {}};
  if (type == "cylinder") return {read_about_axis(node, &ConvexShape::cylinder), {}};
  if (type == "cone") return {read_about_axis(node, &ConvexShape::cone), {}};
  if (type == "mesh") return read_mesh(node, limits);
  if (type == "halfspaces") return read_halfspaces(node, limits);
  if (type == "sphere_hull") return read_sphere_hull(node, limits);
  if (type == "compound" || type == "star") {
    type_node.refuse("unsupported",
                     "this query is for convex shapes; for compounds and star-shaped bodies there are "
                     "depth, distance, intersect, directional_depth, point_in_difference, "
                     "support_of_difference, minkowski_difference, contact_manifold and time_of_impact");
  }
  type_node.refuse("bad_value",
                   "unknown shape; known: convex, box, sphere, ellipsoid, capsule, cylinder, cone, halfspaces, mesh, "
                   "sphere_hull, compound, star");
}

}  // namespace

NamedShape read_shape(const Node& node, const Limits& limits) {
  require_object(node);
  NamedShape shape = read_core(node, limits);
  if (const auto margin_node = node.find("margin")) {
    const double margin = read_number(*margin_node);
    if (margin < 0) margin_node->refuse("bad_value", "a margin must be 0 or greater");
    shape.shape = value_or_refuse(shape.shape.with_margin(margin), node);
  }
  return shape;
}

const ConvexPolytope& require_polytope(const NamedShape& named, const Node& node) {
  if (named.shape.polytope() == nullptr || named.shape.margin() > 0) {
    node.refuse("unsupported", "must be a polytope (convex, box, mesh) without a margin for this query");
  }
  return *named.shape.polytope();
}

Pose read_pose(const Node& node) {
  require_object(node);
  allow_only(node, {"translation", "quaternion_wxyz", "rotation_row_major"});
  Vec3 translation = Vec3::Zero();
  if (const auto translation_node = node.find("translation")) translation = read_vector(*translation_node);

  const auto quaternion = node.find("quaternion_wxyz");
  const auto matrix = node.find("rotation_row_major");
  if (quaternion && matrix) {
    node.refuse("bad_value", "give a quaternion or a matrix, not both");
  }
  const auto pose_or_refuse = [&](const Expected<Pose>& pose, const Node& rotation) {
    if (pose) return *pose;
    const Error& error = pose.error();
    if (error.where.starts_with("translation")) node.refuse(error);
    rotation.refuse(to_string(error.code), error.message);
  };
  if (quaternion) {
    const std::vector<double> q = read_numbers(*quaternion, 4);
    return pose_or_refuse(Pose::from_quaternion({q[0], q[1], q[2], q[3]}, translation), *quaternion);
  }
  Mat3 rotation = Mat3::Identity();
  if (matrix) {
    const std::vector<double> m = read_numbers(*matrix, 9);
    for (int i = 0; i < 9; ++i) rotation(i / 3, i % 3) = m[static_cast<std::size_t>(i)];
  }
  return pose_or_refuse(Pose::from_matrix(rotation, translation), matrix ? *matrix : node);
}

NamedShape load_mesh_shape(const std::string& path, const Limits& limits, MeshAs as) {
  return hull_of_mesh(read_mesh_points(path, limits.max_vertices, kMaxMeshBytes), path, as);
}

void refuse_file(const std::string& name, const Error& error) {
  refuse(to_string(error.code), name + ": " + (error.where.empty() ? "" : error.where + ": ") + error.message, "");
}

NamedShape hull_of_mesh(MeshPoints mesh, const std::string& name, MeshAs as) {
  auto hull = ConvexPolytope::from_points(mesh.points);
  if (!hull) refuse_file(name, hull.error());
  std::optional<HullNote> note;
  if (as == MeshAs::found) note = why_hull(mesh, *hull);
  if (as == MeshAs::hull) note = HullNote{"that is what was asked for", hull->num_vertices(), 0, mesh.left_out};
  return {std::move(hull).value(), std::move(mesh.ids), std::move(note)};
}

}  // namespace pd::query
