#include "protocol/solid_reader.hpp"

#include <algorithm>
#include <utility>

#include "mesh/mesh_groups.hpp"
#include "pd/solid/solid_parts.hpp"
#include "protocol/line/line_notes.hpp"

namespace pd::query {

namespace {

bool is_mesh(const Node& node) {
  if (!node.json().is_object()) return false;
  const auto type = node.json().find("type");
  return type != node.json().end() && *type == "mesh";
}

MeshView view_of(const MeshPoints& mesh) { return {mesh.points, mesh.faces.offsets, mesh.faces.corners}; }

/// "faces 3 and 5 stand in lines 12 and 14"
std::string lines_of(const MeshFinding& finding, const MeshFaces& faces) {
  std::string words;
  for (const std::int32_t face : finding.faces) {
    if (face < 0 || static_cast<std::size_t>(face) >= faces.lines.size()) continue;
    words += (words.empty() ? " (face " : ", face ") + std::to_string(face) + ": line " +
             std::to_string(faces.lines[static_cast<std::size_t>(face)]);
  }
  return words.empty() ? words : words + ")";
}

/// The caller's vertices stand for those that the report names.
MeshFinding as_in_file(MeshFinding finding, const MeshPoints& mesh) {
  for (std::int32_t& v : finding.edge) {
    if (v >= 0 && !mesh.ids.empty()) v = mesh.ids[static_cast<std::size_t>(v)];
  }
  return finding;
}

[[noreturn]] void refuse_fault(const std::string& path, const MeshFinding& finding, const MeshPoints& mesh,
                               const SolidWish& wish) {
  const bool inside_out = finding.fault == MeshFault::inside_out;
  const auto hull = ConvexPolytope::from_points(mesh.points);
  const bool flat = hull && hull->affine_dimension() < 3;
  std::string way_out = inside_out ? "ask for the mesh turned (" + wish.turn_words + ")" : "mend the mesh";
  if (!wish.parts_words.empty() && answers_as_parts(mesh, wish)) {
    way_out += ", ask for the union of its parts (" + wish.parts_words + ")";
  }
  refuse(to_string(finding.fault),
         path + ": " + in_words(as_in_file(finding, mesh)) + lines_of(finding, mesh.faces) +
             (flat ? "; all points lie in one plane, so that no volume is there" : "") + "; " + way_out +
             ", or ask for the convex hull of its vertices (" + wish.hull_words + "). `pdepth check` names every fault",
         "");
}

}  // namespace

MeshBody body_of_mesh(MeshPoints mesh, const std::string& name, const SolidWish& wish) {
  const MeshView view = view_of(mesh);
  const auto hull = [&](MeshAs as) {
    return MeshBody{nullptr, std::make_shared<const NamedShape>(hull_of_mesh(std::move(mesh), name, as))};
  };
  if (mesh.faces.size() == 0 && !wish.always) return hull(MeshAs::found);
  // Crossings are the dearest part, and a convex mesh has none.
  const auto quick = check_mesh(view, {.crossings = false, .extent = wish.extent});
  if (!quick) return hull(MeshAs::found);  // the hull's factory refuses the points by name
  if (quick->convex && quick->loose_points == 0 && !wish.always) return hull(MeshAs::convex);
  if (const auto fault = fault_of_solid(*quick, wish.turn_faces)) refuse_fault(name, *fault, mesh, wish);
  const auto report = check_mesh(view, {.extent = wish.extent});
  if (!report) refuse_file(name, report.error());
  if (const auto fault = fault_of_solid(*report, wish.turn_faces)) refuse_fault(name, *fault, mesh, wish);
  auto solid = MeshSolid::from_checked(view, *report, {.turn_faces = wish.turn_faces});
  if (!solid) {
    refuse(
        to_string(solid.error().code),
        name + ": " + solid.error().message + "; or ask for the convex hull of its vertices (" + wish.hull_words + ")",
        "");
  }
  return {std::make_shared<const MeshSolid>(*std::move(solid)), nullptr};
}

std::shared_ptr<const MeshSolid> read_solid(const Node& node, const Limits& limits) {
  if (!is_mesh(node)) return nullptr;
  allow_only(node, {"type", "margin", "path", "as", "turn_faces"});
  SolidWish wish;
  if (const auto as = node.find("as")) {
    const std::string word = read_string(*as);
    if (word == "hull" || word == "sheet" || word == "parts") return nullptr;
    if (word != "solid") as->refuse("bad_value", kMeshWords);
    wish.always = true;
  }
  wish.turn_faces = read_flag(node, "turn_faces");
  const Node path = node.at("path");
  const std::string file = read_string(path);
  if (!limits.files) path.refuse("unreadable_file", "files are not read here (--no-files)");
  const std::string key = mesh_key(wish.always ? "solid" : "", wish.turn_faces, file);
  LineNotes* const notes = node.notes();
  if (notes != nullptr) {
    if (const auto known = notes->meshes.find(key); known != notes->meshes.end()) return known->second.solid;
  }
  try {
    MeshBody body = body_of_mesh(read_mesh_points(file, limits.max_vertices, kMaxMeshBytes), file, wish);
    if (notes != nullptr) notes->meshes.emplace(key, body);
    return body.solid;
  } catch (const Refusal& refusal) {
    path.refuse(refusal.code, refusal.message);
  }
}

namespace {

bool holds_solid(const Node& node, const Limits& limits, int depth) {
  if (!node.json().is_object() || depth > kMaxCompoundNesting) return false;
  const auto type = node.json().find("type");
  if (type == node.json().end()) return false;
  if (*type == "mesh") return read_solid(node, limits) != nullptr;
  if (*type != "compound") return false;
  const auto parts = node.find("parts");
  if (!parts || !parts->json().is_array()) return false;
  for (std::size_t i = 0; i < parts->size(); ++i) {
    const Node part = parts->element(i);
    if (!part.json().is_object()) continue;
    const auto shape = part.find("shape");
    if (shape && holds_solid(*shape, limits, depth + 1)) return true;
  }
  return false;
}

}  // namespace

bool names_solid(const Node& line, const Limits& limits) {
  for (const std::string_view key : {"a", "b"}) {
    const auto body = line.find(key);
    if (body && holds_solid(*body, limits, 1)) return true;
  }
  return false;
}

namespace {

bool is_union(const Node& node) {
  const auto type = node.find("type");
  return (type && (type->json() == "compound" || type->json() == "star")) || is_mesh_of_parts(node);
}

}  // namespace

std::shared_ptr<const MeshSolid> read_as_solid(const Node& node, const Limits& limits) {
  if (node.find("margin") || is_union(node)) return nullptr;
  if (auto solid = read_solid(node, limits)) {
    node.remark("solid");
    return solid;
  }
  const NamedShape shape = read_shape(node, limits);
  if (shape.shape.polytope() == nullptr) return nullptr;
  auto solid = MeshSolid::from_polytope(*shape.shape.polytope());
  if (!solid) return nullptr;
  return std::make_shared<const MeshSolid>(*std::move(solid));
}

std::optional<ConvexShape> read_beside_solid(const Node& node, const Limits& limits) {
  if (is_union(node) || read_solid(node, limits)) return std::nullopt;
  ConvexShape shape = read_shape(node, limits).shape;
  const ConvexPolytope* const polytope = shape.polytope();
  const bool is_flat = polytope != nullptr && polytope->affine_dimension() < 3 && shape.margin() == 0;
  return is_flat ? std::nullopt : std::optional(std::move(shape));
}

bool is_mesh_of_parts(const Node& node) {
  if (!is_mesh(node)) return false;
  const auto as = node.json().find("as");
  return as != node.json().end() && *as == "parts";
}

namespace {

/// Corners of parts are no vertices of the file.
NamedShape without_ids(const ConvexShape& shape) {
  std::int32_t most = 0;
  for (int v = 0; v < shape.polytope()->num_vertices(); ++v) {
    most = std::max<std::int32_t>(most, shape.polytope()->caller_id(v));
  }
  return {shape, std::vector<std::int32_t>(static_cast<std::size_t>(most) + 1, -1)};
}

/// The convex parts of a solid, which are the solid exactly. @param name  of the solid, in front of the refusal
std::vector<NamedShape> exact_parts(const MeshSolid& solid, const std::string& name, const std::string& way_out) {
  const auto parts = SolidParts::from_solid(solid);
  if (!parts) refuse(to_string(parts.error().code), name + parts.error().message + way_out, "");
  if (!parts->exact()) {
    refuse(
        "unsupported",
        name +
            "this query needs the solid as convex parts, and those along its faces have corners that no doubles hold" +
            way_out,
        "");
  }
  std::vector<NamedShape> shapes;
  for (const Compound::Part& part : parts->inner().parts()) shapes.push_back(without_ids(part.shape));
  return shapes;
}

/// @throws Refusal limit_exceeded for more shapes than a compound holds.
NamedBody union_of(std::vector<NamedShape> shapes) {
  std::vector<Compound::Part> parts;
  for (const NamedShape& shape : shapes) parts.push_back({shape.shape, Pose()});
  auto compound = Compound::from_parts(std::move(parts));
  if (!compound) refuse(to_string(compound.error().code), compound.error().message, "");
  return {*std::move(compound), std::move(shapes)};
}

/// The largest extent along an axis.
double extent_of(const MeshPoints& mesh) {
  Vec3 low = mesh.points.front(), high = low;
  for (const Vec3& p : mesh.points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  return (high - low).maxCoeff();
}

/// The length of which a part's precision is a share: the file's size, since its text is rounded in one place, but at
/// most ten times the part's own, so that a small part keeps its notches beside a large one.
double precision_extent(const MeshPoints& part, const MeshPoints& file) {
  constexpr double kMost = 10;
  return std::min(extent_of(file), kMost * extent_of(part));
}

bool bounds_solid(const MeshPoints& mesh, const SolidWish& wish) {
  const MeshView view = view_of(mesh);
  const auto report = check_mesh(view, {.extent = wish.extent});
  return report && MeshSolid::from_checked(view, *report, {.turn_faces = wish.turn_faces}).has_value();
}

/// The group, or its surfaces where it bounds no solid as a whole and each of them is closed.
std::vector<MeshGroup> bodies_of(const MeshGroup& group, const SolidWish& wish) {
  std::vector<MeshGroup> surfaces = surfaces_of(group);
  if (surfaces.size() < 2 || bounds_solid(group.mesh, wish)) return {group};
  for (const MeshGroup& surface : surfaces) {
    const auto report = check_mesh(view_of(surface.mesh), {.crossings = false});
    if (!report || !report->closed()) return {group};
  }
  return surfaces;
}

/// A part that shows its inside, among others that do not, may be a cavity, whose faces must not be turned.
/// @throws Refusal inside_out
void refuse_cavities(const std::vector<MeshGroup>& parts, const std::string& name, const SolidWish& wish) {
  std::vector<const MeshGroup*> inside_out;
  for (const MeshGroup& part : parts) {
    const auto report = check_mesh(view_of(part.mesh), {.crossings = false});
    if (report && report->relative_volume < 0) inside_out.push_back(&part);
  }
  if (inside_out.empty() || inside_out.size() == parts.size()) return;
  refuse(
      "inside_out",
      name + ": " + inside_out.front()->name + ": " + std::to_string(inside_out.size()) + " of " +
          std::to_string(parts.size()) +
          " parts show their insides, and cavities cannot be told from parts there; let all of them show their "
          "outsides, make each cavity one group with the part around it, or ask for the convex hull of the vertices (" +
          wish.hull_words + ")",
      "");
}

}  // namespace

NamedBody parts_of_mesh(const MeshPoints& mesh, const std::string& name, const SolidWish& wish) {
  const std::vector<MeshGroup> groups = groups_of(mesh);
  if (groups.empty()) refuse("bad_faces", name + ": the file holds points and no faces, and so no parts", "");
  const std::string alone = has_parts(mesh) ? ", once the part stands in a file of its own" : "";
  const std::string way_out = "; `pdepth decompose` writes convex parts with a stated error" + alone + ", and " +
                              wish.hull_words + " asks for the hull";
  std::vector<NamedShape> shapes;
  SolidWish part_wish = wish;
  part_wish.parts_words.clear();
  std::vector<MeshGroup> parts;
  for (const MeshGroup& group : groups) {
    part_wish.extent = precision_extent(group.mesh, mesh);
    for (MeshGroup& part : bodies_of(group, part_wish)) parts.push_back(std::move(part));
  }
  refuse_cavities(parts, name, wish);
  for (MeshGroup& part : parts) {
    const std::string full_name = name + ": " + part.name;
    part_wish.extent = precision_extent(part.mesh, mesh);
    const MeshBody body = body_of_mesh(std::move(part.mesh), full_name, part_wish);
    if (body.hull) {
      shapes.push_back(*body.hull);
      continue;
    }
    for (NamedShape& shape : exact_parts(*body.solid, full_name + ": ", way_out)) shapes.push_back(std::move(shape));
  }
  return union_of(std::move(shapes));
}

bool answers_as_parts(const MeshPoints& mesh, const SolidWish& wish) {
  constexpr std::int64_t kMostFaces = 5'000;  // a trial of as many takes some 0.3 s at worst
  if (mesh.faces.size() > kMostFaces || !has_parts(mesh)) return false;
  try {
    return !parts_of_mesh(mesh, "", wish).compound.parts().empty();
  } catch (const Refusal&) {
    return false;
  }
}

NamedBody read_mesh_parts(const Node& node, const Limits& limits) {
  allow_only(node, {"type", "margin", "path", "as", "turn_faces"});
  const Node path = node.at("path");
  const std::string file = read_string(path);
  if (!limits.files) path.refuse("unreadable_file", "files are not read here (--no-files)");
  SolidWish wish;
  wish.turn_faces = read_flag(node, "turn_faces");
  try {
    NamedBody body = parts_of_mesh(read_mesh_points(file, limits.max_vertices, kMaxMeshBytes), file, wish);
    node.remark("parts");
    return body;
  } catch (const Refusal& refusal) {
    path.refuse(refusal.code, refusal.message);
  }
}

NamedBody parts_of_solid(const MeshSolid& solid, const Node& node) {
  try {
    NamedBody body = union_of(exact_parts(solid, "",
                                          "; depth, distance and intersect of solids and convex polytopes need no "
                                          "parts, and \"as\":\"hull\" asks for the convex hull"));
    node.remark("solid");
    return body;
  } catch (const Refusal& refusal) {
    node.refuse(refusal.code, refusal.message);
  }
}

}  // namespace pd::query
