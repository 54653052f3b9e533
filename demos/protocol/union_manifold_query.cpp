/// @file
/// contact_manifold of bodies of many pieces: compounds, star-shaped bodies, solids, and meshes as sheets of triangles.
#include <string>

#include "pd/union_contact/union_manifold.hpp"
#include "protocol/pair_reader.hpp"
#include "protocol/union_queries.hpp"

namespace pd::query {

namespace {

bool is_sheet(const Node& line, std::string_view key) {
  const auto body = line.find(key);
  if (!body || !body->json().is_object()) return false;
  const auto type = body->json().find("type"), as = body->json().find("as");
  return type != body->json().end() && *type == "mesh" && as != body->json().end() && *as == "sheet";
}

/// Reads the faces of a mesh file as a sheet. Refusals name faces by their numbers in the file, from 0.
PieceBody read_sheet(const Node& node, const Limits& limits) {
  allow_only(node, {"type", "margin", "path", "as", "turn_faces"});
  if (const auto turn = node.find("turn_faces")) {
    turn->refuse("bad_value", "the faces of a sheet are taken as they run; turn_faces is for solids");
  }
  double margin = 0;
  if (const auto margin_node = node.find("margin")) {
    margin = read_number(*margin_node);
    if (margin < 0) margin_node->refuse("bad_value", "a margin must be 0 or greater");
  }
  const Node path = node.at("path");
  const std::string file = read_string(path);
  if (!limits.files) path.refuse("unreadable_file", "files are not read here (--no-files)");
  try {
    const MeshPoints mesh = read_mesh_points(file, limits.max_vertices, kMaxMeshBytes);
    const auto sheet = PieceBody::of_sheet({mesh.points, mesh.faces.offsets, mesh.faces.corners}, margin);
    if (!sheet)
      path.refuse(to_string(sheet.error().code), file + ": " + sheet.error().where + ": " + sheet.error().message);
    node.remark("sheet");
    return sheet.value();
  } catch (const Refusal& refusal) {
    if (!refusal.where.empty()) throw;
    path.refuse(refusal.code, refusal.message);
  }
}

PieceBody read_pieces(const Node& line, std::string_view key, const Limits& limits) {
  const Node node = line.at(key);
  if (is_sheet(line, key)) return read_sheet(node, limits);
  return PieceBody::of_compound(read_body(node, limits).compound);
}

void write_patch(const UnionContactPatch& patch, JsonWriter& answer) {
  answer.key("normal").vector(patch.normal);
  answer.key("points").begin_array();
  for (int k = 0; k < patch.count; ++k) {
    const UnionContactPoint& point = patch.points[static_cast<std::size_t>(k)];
    answer.begin_object();
    write_contact_point(point.contact, answer);
    answer.key("normal").vector(point.normal);
    answer.key("piece_a").integer(point.piece_a);
    answer.key("piece_b").integer(point.piece_b);
    answer.end_object();
  }
  answer.end_array();
}

}  // namespace

bool names_sheet(const Node& line) { return is_sheet(line, "a") || is_sheet(line, "b"); }

void answer_union_contact_manifold(const Node& line, Session& session, JsonWriter& answer) {
  allow_only(line, {"id", "query", "a", "pose_a", "b", "pose_b", "breaking_threshold", "one_sided"});
  UnionContactSettings settings;
  settings.breaking_threshold = read_breaking_threshold(line);
  settings.one_sided = read_flag(line, "one_sided");
  const PieceBody a = read_pieces(line, "a", session.limits), b = read_pieces(line, "b", session.limits);
  const Pose pose_a = read_optional_pose(line, "pose_a"), pose_b = read_optional_pose(line, "pose_b");
  UnionManifoldScratch scratch{session.scratch, session.manifold_scratch};
  const UnionManifold found = value_or_refuse(union_manifold({&a, pose_a}, {&b, pose_b}, settings, scratch), line);
  if (found.patches.empty()) {
    answer.key("normal");
    if (found.normal.isZero(0)) {
      answer.null();
    } else {
      answer.vector(found.normal);
    }
    answer.key("points").begin_array().end_array();
  } else {
    write_patch(found.patches.front(), answer);
  }
  answer.key("patches").begin_array();
  for (const UnionContactPatch& patch : found.patches) {
    answer.begin_object();
    write_patch(patch, answer);
    answer.end_object();
  }
  answer.end_array();
  if (found.piece_a >= 0) answer.key("part_a").integer(found.piece_a).key("part_b").integer(found.piece_b);
  answer.key("covered").integer(found.covered);
}

}  // namespace pd::query
