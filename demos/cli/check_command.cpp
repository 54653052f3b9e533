/// @file
/// `pdepth check FILE`: does a mesh bound a solid, and is it convex? For people who have never heard of manifolds, or
/// with --json for programs.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "body_argument.hpp"
#include "commands.hpp"
#include "mesh/hull_note.hpp"
#include "mesh/mesh_file.hpp"
#include "options.hpp"
#include "pd/shape/convex_polytope.hpp"
#include "pd/shape/mesh_solid.hpp"
#include "protocol/line/json_writer.hpp"
#include "protocol/line/limits.hpp"
#include "protocol/solid_reader.hpp"
#include "support/complain.hpp"
#include "support/printable.hpp"
#include "support/refusal.hpp"

namespace pd::cli {

namespace {

constexpr const char* kCheckFooter =
    R"(A mesh bounds a solid when its faces leave no hole, all show their outside, and nowhere cross or meet a third face.

The last row, and "asked_as" with --json, says how the other commands take the file: as the convex body, as the solid that its
faces bound, as the hull of its points, or not at all (refused), with the code of the refusal and the ways out.

--fail-on takes words between commas; the exit code is 3 when one of them applies:
  open_edge        a face has no neighbour at an edge: the surface has a hole
  flipped_face     two neighbours show opposite sides
  not_manifold     more than two faces meet at an edge, or parts of the surface touch in a vertex
  self_crossing    two faces cross or touch where they are no neighbours
  inside_out       all faces show their inside
  not_planar       the corners of a polygon lie in no plane
  degenerate_face  a face without an area
  not_convex       the mesh is not its convex hull
  duplicate_points a point stands twice in the file
  solid            any of the first six

Examples:
  pdepth check part.stl
  pdepth check part.obj --fail-on solid,not_convex)";

struct CheckArguments {
  std::string file;
  std::string fail_on;
  bool json = false;
};

constexpr std::int64_t kMostChecked = 50'000'000;

/// A file, its check, and its hull.
struct CheckedMesh {
  std::string file;
  query::MeshPoints mesh;
  SurfaceReport report;
  ConvexPolytope hull;
  std::optional<Error> refusal = {};  ///< of the solid that the queries would make

  [[nodiscard]] double volume(double relative) const { return relative * std::pow(report.size, 3); }
  [[nodiscard]] double hull_volume() const { return report.size > 0 ? query::relative_volume(hull, report.size) : 0; }
  [[nodiscard]] bool encloses() const { return report.closed() && report.oriented(); }
};

/// Makes the solid that the queries would make, where the report shows no fault. A surface that lies inside of another
/// part, and is no cavity, is found there.
void make_solid(CheckedMesh& checked) {
  SurfaceReport& report = checked.report;
  if (report.faces == 0 || !report.crossings_searched || fault_of_solid(report)) return;
  const MeshView mesh{checked.mesh.points, checked.mesh.faces.offsets, checked.mesh.faces.corners};
  const auto solid = MeshSolid::from_checked(mesh, report);
  if (solid) return;
  checked.refusal = solid.error();
  constexpr std::string_view kFaces = "faces[";
  if (!solid.error().message.starts_with(to_string(MeshFault::inside_out))) return;
  const auto face = static_cast<std::int32_t>(std::strtol(solid.error().where.c_str() + kFaces.size(), nullptr, 10));
  report.counts[static_cast<std::size_t>(MeshFault::inside_out)] = 1;
  report.findings.push_back({.fault = MeshFault::inside_out, .faces = {face, -1}});
}

CheckedMesh read_checked(const std::string& file) {
  query::MeshPoints mesh = read_mesh_argument(file, kMostChecked);
  auto report = check_mesh({mesh.points, mesh.faces.offsets, mesh.faces.corners});
  if (!report) query::refuse_file(file, report.error());
  auto hull = ConvexPolytope::from_points(mesh.points);
  if (!hull) query::refuse_file(file, hull.error());
  CheckedMesh checked{file, std::move(mesh), *std::move(report), *std::move(hull)};
  make_solid(checked);
  return checked;
}

/// The body as which the queries take the file.
enum class AskedAs { convex, solid, hull, refused };

constexpr const char* to_string(AskedAs as) {
  constexpr std::array<const char*, 4> kWords = {"convex", "solid", "hull", "refused"};
  return kWords[static_cast<std::size_t>(as)];
}

AskedAs asked_as(const CheckedMesh& checked) {
  if (checked.report.faces == 0) return AskedAs::hull;
  if (!query::why_hull(checked.report, checked.hull)) return AskedAs::convex;
  const bool solid = checked.report.crossings_searched && !fault_of_solid(checked.report) && !checked.refusal;
  return solid ? AskedAs::solid : AskedAs::refused;
}

/// The code of the refusal; the file is one that queries refuse.
std::string refused_as(const CheckedMesh& checked) {
  if (checked.refusal) return std::string(to_string(checked.refusal->code));
  const auto fault = fault_of_solid(checked.report);
  return fault ? std::string(to_string(fault->fault)) : "limit_exceeded";
}

// ---- words for people --------------------------------------------------------------------------------------------

std::string point_in_words(const Vec3& p) { return fmt::format("({:.9g}, {:.9g}, {:.9g})", p.x(), p.y(), p.z()); }

/// "face 12 (line 40)", from 0 as refusals and answers count.
std::string face_in_words(const CheckedMesh& checked, std::int32_t face) {
  const auto& lines = checked.mesh.faces.lines;
  const std::string line = lines.empty() ? "" : fmt::format(" (line {})", lines[static_cast<std::size_t>(face)]);
  return fmt::format("face {}{}", face, line);
}

std::string place_in_words(const CheckedMesh& checked, const MeshFinding& finding) {
  const auto point = [&](std::int32_t v) { return point_in_words(checked.mesh.points[static_cast<std::size_t>(v)]); };
  std::string words;
  if (finding.edge[1] >= 0) {
    words = fmt::format("the edge from {} to {}", point(finding.edge[0]), point(finding.edge[1]));
  } else if (finding.edge[0] >= 0) {
    words = "the vertex " + point(finding.edge[0]);
  }
  if (finding.faces[0] >= 0) words += (words.empty() ? "" : " of ") + face_in_words(checked, finding.faces[0]);
  if (finding.faces[1] >= 0) words += " and " + face_in_words(checked, finding.faces[1]);
  return words;
}

void print_places(const CheckedMesh& checked, MeshFault fault) {
  std::int64_t shown = 0;
  for (const MeshFinding& finding : checked.report.findings) {
    if (finding.fault != fault) continue;
    print_row("", "  " + place_in_words(checked, finding));
    ++shown;
  }
  const std::int64_t more = checked.report.count(fault) - shown;
  if (more > 0) print_row("", fmt::format("  and {} more", more));
}

/// Words for a fault: "no: 1 edge has a hole beside it", "no: 2 edges have ...".
struct Wrong {
  const char* before;  ///< the count
  const char* one;
  const char* many;
};

/// A row of the check: what is good, or what is wrong and where.
void print_judged(const CheckedMesh& checked, std::string_view name, MeshFault fault, const std::string& good,
                  const Wrong& wrong) {
  const std::int64_t count = checked.report.count(fault);
  if (checked.report.faces == 0 || (checked.report.shells == 0 && fault != MeshFault::degenerate_face)) return;
  print_row(name,
            count == 0 ? good : fmt::format("{} {} {}", wrong.before, count, count == 1 ? wrong.one : wrong.many));
  print_places(checked, fault);
}

std::string verdict(const CheckedMesh& checked) {
  const SurfaceReport& report = checked.report;
  if (report.faces == 0) return "The file holds points and no faces: it bounds no solid.";
  if (!report.solid()) return "The faces do not bound a solid. What is in the way stands below.";
  if (!report.crossings_searched) return "No fault was found; faces that cross were not searched to the end.";
  if (!report.convex) return "The faces bound a solid, which is not convex.";
  return report.loose_points > 0 ? "The faces bound a convex solid, and points lie beside it."
                                 : "The faces bound a solid, and it is convex.";
}

std::string queries_in_words(const CheckedMesh& checked) {
  const std::string ask_hull =
      "`pdepth depth --hull`, or \"as\":\"hull\" in a line of `pdepth query`, asks for the hull";
  switch (asked_as(checked)) {
    case AskedAs::convex:
      return checked.report.count(MeshFault::inside_out) > 0 ? "ask for the convex body, whichever side its faces show"
                                                             : "ask for the convex body";
    case AskedAs::hull:
      return "ask for the convex hull of the points";
    case AskedAs::solid:
      return "ask for the solid that the faces bound; " + ask_hull;
    case AskedAs::refused:
      break;
  }
  const bool turns = !fault_of_solid(checked.report, true) && checked.report.crossings_searched;
  const bool parts = query::answers_as_parts(checked.mesh, {});
  return "refuse the file (" + refused_as(checked) +
         "): " + (turns ? "turn the faces, by \"turn_faces\":true in a line of `pdepth query`" : "mend the mesh") +
         (parts ? "; `pdepth depth --parts`, or \"as\":\"parts\", asks for the union of its parts" : "") + "; " +
         ask_hull;
}

void print_report(const CheckedMesh& checked) {
  const SurfaceReport& report = checked.report;
  fmt::print("\n  {}\n\n  {}\n\n", printable(checked.file), verdict(checked));
  const std::int64_t repeated = report.points - report.vertices;
  const std::int64_t left_out = checked.mesh.left_out;
  print_row(
      "points",
      fmt::format("{}{}{}", report.points, repeated > 0 ? fmt::format(", {} of them repeat another", repeated) : "",
                  left_out > 0 ? fmt::format("; {} without a measurement (NaN) are left out", left_out) : ""));
  print_row("faces", fmt::format("{} in {} connected {}", report.faces, report.shells,
                                 report.shells == 1 ? "surface" : "surfaces"));
  const Vec3 extent = report.high - report.low;
  print_row("size", fmt::format("{:.6g} x {:.6g} x {:.6g}, from {} to {}", extent.x(), extent.y(), extent.z(),
                                point_in_words(report.low), point_in_words(report.high)));
  print_judged(
      checked, "closed", MeshFault::open_edge, "yes: every edge has a face on both sides",
      {"no: the surface has holes;", "edge has a face on one side only", "edges have a face on one side only"});
  print_judged(checked, "oriented", MeshFault::flipped_face, "yes: neighbouring faces show the same side",
               {"no:", "edge where one neighbour shows its outside and the other its inside",
                "edges where one neighbour shows its outside and the other its inside"});
  print_judged(checked, "manifold", MeshFault::not_manifold, "yes: no third face meets at an edge",
               {"no:", "edge or vertex where more faces meet than the two sides of a surface",
                "edges or vertices where more faces meet than the two sides of a surface"});
  print_judged(checked, "crossings", MeshFault::self_crossing,
               report.crossings_searched ? "none: faces meet only at common edges and vertices"
                                         : "none found, but the search was ended early",
               {"yes:", "pair of faces crosses or touches where they are no neighbours",
                "pairs of faces cross or touch where they are no neighbours"});
  print_judged(
      checked, "outside", MeshFault::inside_out,
      checked.encloses() ? "faces show their outside" : "cannot be told before the surface is closed and oriented",
      {"wrong way round:",
       checked.refusal ? "surface lies inside of another part; a cavity shows its faces the other way"
                       : "surface shows its inside; turn the faces",
       "surfaces show their inside; turn the faces"});
  if (report.count(MeshFault::not_planar) > 0) {
    print_judged(checked, "flat", MeshFault::not_planar, "",
                 {"no:", "polygon whose corners lie in no plane", "polygons whose corners lie in no plane"});
  }
  if (report.count(MeshFault::degenerate_face) > 0) {
    print_judged(checked, "slivers", MeshFault::degenerate_face, "",
                 report.has_area()
                     ? Wrong{"yes:", "face has no area, which does no harm", "faces have no area, which does no harm"}
                     : Wrong{"no other:", "face, and it has no area", "faces, and none has an area"});
  }
  if (checked.encloses()) print_row("volume", fmt::format("{:.10g}", checked.volume(report.relative_volume)));
  const auto note = query::why_hull(report, checked.hull);
  const double times = note ? note->times_as_large : 0;
  print_row("hull", fmt::format("{} vertices, volume {:.10g}{}", checked.hull.num_vertices(),
                                checked.volume(checked.hull_volume()),
                                times > 0 ? fmt::format(", {:.4g} times the mesh's volume", times) : ""));
  if (report.faces > 0) print_row("convex", !note ? "yes: the mesh is its own convex hull" : "no: " + note->reason);
  print_row("queries", queries_in_words(checked));
  fmt::print("\n");
}

// ---- for programs ------------------------------------------------------------------------------------------------

void print_json(const CheckedMesh& checked) {
  const SurfaceReport& report = checked.report;
  std::string out;
  query::JsonWriter writer(out);
  writer.begin_object();
  writer.key("file").string(checked.file);
  writer.key("solid").boolean(report.solid()).key("closed").boolean(report.closed());
  writer.key("oriented").boolean(report.oriented()).key("manifold").boolean(report.manifold());
  writer.key("convex").boolean(!query::why_hull(report, checked.hull));
  writer.key("asked_as").string(to_string(asked_as(checked)));
  if (asked_as(checked) == AskedAs::refused) writer.key("refused_as").string(refused_as(checked));
  writer.key("crossings_searched").boolean(report.crossings_searched);
  writer.key("points").integer(report.points).key("duplicate_points").integer(report.points - report.vertices);
  if (checked.mesh.left_out > 0) writer.key("points_left_out").integer(checked.mesh.left_out);
  writer.key("loose_points").integer(report.loose_points);
  writer.key("faces").integer(report.faces).key("surfaces").integer(report.shells);
  writer.key("low").vector(report.low).key("high").vector(report.high);
  writer.key("faults").begin_object();
  for (std::size_t f = 0; f < kMeshFaults; ++f) {
    if (report.counts[f] > 0) writer.key(to_string(static_cast<MeshFault>(f))).integer(report.counts[f]);
  }
  writer.end_object();
  // Beyond the range of doubles a volume is left out.
  const double volume = checked.volume(report.relative_volume), hull = checked.volume(checked.hull_volume());
  if (checked.encloses() && std::isfinite(volume)) writer.key("volume").number(volume);
  if (std::isfinite(hull)) writer.key("hull_volume").number(hull);
  writer.key("hull_vertices").integer(checked.hull.num_vertices());
  writer.key("findings").begin_array();
  for (const MeshFinding& finding : report.findings) {
    writer.begin_object().key("fault").string(to_string(finding.fault));
    writer.key("where").string(place_in_words(checked, finding)).end_object();
  }
  writer.end_array().end_object();
  fmt::print("{}\n", out);
}

/// Does the word apply? Refused where it is no word of --fail-on.
bool applies(const std::string& word, const CheckedMesh& checked) {
  const SurfaceReport& report = checked.report;
  if (word == "not_convex") return query::why_hull(report, checked.hull).has_value();
  if (word == "duplicate_points") return report.vertices < report.points;
  if (word == "solid") return !report.solid();
  for (std::size_t f = 0; f < kMeshFaults; ++f) {
    if (word == to_string(static_cast<MeshFault>(f))) return report.counts[f] > 0;
  }
  std::string known = "solid, not_convex, duplicate_points";
  for (std::size_t f = 0; f < kMeshFaults; ++f) known += ", " + std::string(to_string(static_cast<MeshFault>(f)));
  query::refuse("bad_value", "--fail-on: there is no \"" + word + "\"; known: " + known, "");
}

int run_check(const CheckArguments& arguments) {
  try {
    const CheckedMesh checked = read_checked(arguments.file);
    std::vector<std::string> failed;
    for (const std::string& word : CLI::detail::split(arguments.fail_on, ',')) {
      if (!word.empty() && applies(word, checked)) failed.push_back(word);
    }
    if (arguments.json) {
      print_json(checked);
    } else {
      print_report(checked);
    }
    if (failed.empty()) return kDone;
    complain("{} of --fail-on {}: {}", fmt::join(failed, ", "), failed.size() == 1 ? "applies" : "apply",
             arguments.file);
    return kConditionFails;
  } catch (const query::Refusal& refusal) {
    complain("{}{}", refusal.message, refusal.where.empty() ? "" : " at " + refusal.where);
    return kBadUsage;
  }
}

}  // namespace

void add_check_command(CLI::App& app, Action& action) {
  auto arguments = std::make_shared<CheckArguments>();
  CLI::App* command = app.add_subcommand("check", "Does a mesh bound a solid, and is it convex?");
  command->footer(kCheckFooter);
  command->add_option("FILE", arguments->file, "Mesh or points: OBJ, STL, PLY, OFF, glTF, XYZ or PCD")->required();
  command->add_option("--fail-on", arguments->fail_on, "Faults that end the command with exit code 3");
  command->add_flag("--json", arguments->json, "Print one JSON object");
  command->callback([arguments, &action] { action = [arguments] { return run_check(*arguments); }; });
}

}  // namespace pd::cli
