#include "protocol/body_reader.hpp"

#include <array>
#include <string>
#include <utility>

#include "pd/shape/star_body.hpp"
#include "protocol/pair_reader.hpp"
#include "protocol/solid_reader.hpp"

namespace pd::query {

namespace {

bool is_non_convex(const Node& line, std::string_view key) {
  const auto body = line.find(key);
  if (!body || !body->json().is_object()) return false;
  const auto type = body->json().find("type");
  if (type == body->json().end()) return false;
  return *type == "compound" || *type == "star" || is_mesh_of_parts(*body);
}

NamedBody read_nested(const Node& node, const Limits& limits, int depth);

NamedBody read_compound(const Node& node, const Limits& limits, int depth) {
  allow_only(node, {"type", "margin", "parts"});
  const Node parts = node.at("parts");
  require_array(parts, "an array of parts");
  if (parts.size() == 0) parts.refuse("bad_value", "a compound needs a part at least");
  if (depth > kMaxCompoundNesting) {
    node.refuse("limit_exceeded", "compounds may nest " + std::to_string(kMaxCompoundNesting) + " deep");
  }
  std::vector<Compound::Placed> bodies;
  std::vector<NamedShape> named;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const Node part = parts.element(i);
    require_object(part);
    allow_only(part, {"shape", "pose"});
    NamedBody body = read_nested(part.at("shape"), limits, depth + 1);
    bodies.push_back({std::move(body.compound), read_optional_pose(part, "pose")});
    for (NamedShape& shape : body.parts) named.push_back(std::move(shape));
    if (named.size() > static_cast<std::size_t>(limits.max_vertices)) {
      parts.refuse("limit_exceeded", "more parts than --max-vertices");
    }
  }
  return {value_or_refuse(Compound::from_compounds(bodies), node), std::move(named)};
}

NamedBody read_star(const Node& node, const Limits& limits) {
  allow_only(node, {"type", "margin", "vertices", "faces", "center"});
  const std::vector<Vec3> points = read_points(node.at("vertices"), limits.max_vertices);
  const Node faces_node = node.at("faces");
  require_array(faces_node, "an array of triangles [i,j,k]");
  if (faces_node.size() > 2 * static_cast<std::size_t>(limits.max_vertices)) {
    faces_node.refuse("limit_exceeded", "more faces than a surface with --max-vertices vertices can have");
  }
  std::vector<StarBody::Triangle> faces;
  for (std::size_t f = 0; f < faces_node.size(); ++f) {
    const Node face = faces_node.element(f);
    require_array(face, "a triangle [i,j,k]");
    if (face.size() != 3) face.refuse("bad_faces", "a star-shaped body's faces are triangles [i,j,k]");
    StarBody::Triangle corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      corners[k] = static_cast<std::int32_t>(read_integer(face.element(k), INT32_MIN, INT32_MAX));
    }
    faces.push_back(corners);
  }
  const StarBody star = value_or_refuse(StarBody::from_faces(points, faces, read_vector(node.at("center"))), node);
  NamedBody body{star.tetrahedra(), {}};
  for (std::size_t f = 0; f < faces.size(); ++f) {
    // Ids of the face's corners; the centre is no vertex of the caller's surface.
    body.parts.push_back({body.compound.parts()[f].shape, {faces[f][0], faces[f][1], faces[f][2], -1}});
  }
  return body;
}

NamedBody read_nested(const Node& node, const Limits& limits, int depth) {
  require_object(node);
  const std::string type = read_string(node.at("type"));
  const bool parts = is_mesh_of_parts(node);
  const auto solid = type == "mesh" ? read_solid(node, limits) : nullptr;
  if (type != "compound" && type != "star" && !solid && !parts) {
    NamedShape shape = read_shape(node, limits);
    Compound compound(shape.shape);
    return {std::move(compound), {std::move(shape)}};
  }
  NamedBody body = parts                ? read_mesh_parts(node, limits)
                   : solid              ? parts_of_solid(*solid, node)
                   : type == "compound" ? read_compound(node, limits, depth)
                                        : read_star(node, limits);
  if (const auto margin_node = node.find("margin")) {
    const double margin = read_number(*margin_node);
    if (margin < 0) margin_node->refuse("bad_value", "a margin must be 0 or greater");
    body.compound = value_or_refuse(body.compound.with_margin(margin), node);
  }
  return body;
}

}  // namespace

std::vector<int> NamedBody::feature_ids(int part, const Feature& feature) const {
  std::vector<int> ids = query::feature_ids(feature, parts[static_cast<std::size_t>(part)]);
  std::erase(ids, -1);
  return ids;
}

bool names_non_convex(const Node& line) { return is_non_convex(line, "a") || is_non_convex(line, "b"); }

NamedBody read_body(const Node& node, const Limits& limits) { return read_nested(node, limits, 1); }

}  // namespace pd::query
