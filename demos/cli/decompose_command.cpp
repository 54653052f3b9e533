/// @file
/// `pdepth decompose MESH --error E -o PARTS.obj`: a closed mesh in, convex parts with a certified error out.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "body_argument.hpp"
#include "commands.hpp"
#include "files/decimal_number.hpp"
#include "mesh/mesh_file.hpp"
#include "options.hpp"
#include "pd/numeric/whole_file.hpp"
#include "pd/solid/convex_decomposition.hpp"
#include "progress.hpp"
#include "protocol/line/limits.hpp"
#include "protocol/pair_reader.hpp"
#include "protocol/solid_reader.hpp"
#include "support/complain.hpp"
#include "support/refusal.hpp"

namespace pd::cli {

namespace {

constexpr const char* kDecomposeFooter =
    R"(The mesh must bound a solid (`pdepth check` tells). By default the parts cover the solid:
  outer   every point of the solid lies in a part, and no point of a part is farther from the solid than the error
  --inside  every part lies in the solid, and no point of the solid is farther from the parts than the error

The error is a length in the file's unit, or with % a share of the diagonal of the mesh's bounding box. What is printed as
"error" is certified for every point, and not sampled. The parts are few, but not the fewest that there are.

Where --max-parts or --max-steps ends the work early, the parts are written all the same and the row "error" says that the
error was not reached; the exit code is then 3.

Examples:
  pdepth decompose gear.obj --error 1e-3 -o parts.obj
  pdepth decompose gear.stl --error 1% --inside -o inside.obj)";

struct DecomposeArguments {
  std::string input;
  std::string output;
  std::string error = "1%";
  bool inside = false;
  bool turn_faces = false;
  bool json = false;
  std::int64_t max_parts = DecompositionSettings().max_parts;
  std::int64_t max_steps = DecompositionSettings().max_steps;
};

constexpr std::int64_t kMostMeshPoints = 50'000'000;

double diagonal_of(const MeshSolid& solid) {
  const TriangleNode& root = solid.nodes().front();
  const Vec3 half = 0.5 * root.high - 0.5 * root.low;
  const double largest = half.cwiseAbs().maxCoeff();
  return largest > 0 ? 2 * largest * (half / largest).norm() : 0;
}

/// "0.01", or "1%" of the diagonal.
double read_error(const std::string& text, double diagonal) {
  std::string_view number = text;
  const bool share = number.ends_with('%');
  if (share) number.remove_suffix(1);
  double value = 0;
  if (!query::parse_decimal(number, value)) {
    query::refuse("bad_value", "--error: \"" + text + "\" is no number, and no number with %", "");
  }
  if (share) value *= diagonal / 100;
  if (!(value > 0) || !std::isfinite(value)) {
    query::refuse("bad_value", "--error: must be finite and greater than 0", "");
  }
  return value;
}

std::string obj_of(const SolidDecomposition& found, const DecomposeArguments& arguments) {
  std::string text = fmt::format("# {} convex parts that {} {}; certified error {}\n", found.parts.parts().size(),
                                 arguments.inside ? "lie in" : "cover", printable(arguments.input), found.error);
  const auto out = std::back_inserter(text);
  std::int64_t first = 1, number = 0;
  for (const Compound::Part& part : found.parts.parts()) {
    const ConvexPolytope& polytope = *part.shape.polytope();
    fmt::format_to(out, "o part_{}\n", number++);
    for (int v = 0; v < polytope.num_vertices(); ++v) {
      const Vec3 p = polytope.vertex(v);
      fmt::format_to(out, "v {} {} {}\n", p.x(), p.y(), p.z());
    }
    for (int f = 0; f < polytope.num_facets(); ++f) {
      text += "f";
      for (const std::int32_t v : polytope.facet_vertices(f)) fmt::format_to(out, " {}", first + v);
      text += "\n";
    }
    first += polytope.num_vertices();
  }
  return text;
}

struct Outcome {
  const MeshSolid& solid;
  const SolidDecomposition& found;
  double asked = 0;
  std::int64_t nanoseconds = 0;

  [[nodiscard]] int most_vertices() const {
    int most = 0;
    for (const Compound::Part& part : found.parts.parts()) most = std::max(most, part.shape.polytope()->num_vertices());
    return most;
  }
};

/// False for solids of 1e103 or more in size, and of 1e-108 or less: their volumes are no doubles.
bool has_volumes(const SolidDecomposition& found) {
  return found.solid_volume > 0 && found.parts_volume > 0 && std::isfinite(found.solid_volume) &&
         std::isfinite(found.parts_volume);
}

void print_text(const DecomposeArguments& arguments, const Outcome& outcome) {
  const SolidDecomposition& found = outcome.found;
  const std::string volume = has_volumes(found) ? fmt::format(", volume {:.6g}", found.solid_volume) : "";
  print_row("solid", fmt::format("{}  ({} triangles{})", arguments.input, outcome.solid.triangles().size(), volume));
  print_row("parts", fmt::format("{}  ({} of at most {} vertices, {})", arguments.output, found.parts.parts().size(),
                                 outcome.most_vertices(), duration_in_words(outcome.nanoseconds)));
  print_row("error",
            fmt::format("at most {:.6g}, certified; asked: {:.6g}{}", found.error, outcome.asked,
                        found.error_reached ? "" : " (not reached: --max-parts or --max-steps ended the work)"));
  print_row("error_reached", found.error_reached ? "yes" : "no");
  print_row("side", arguments.inside ? "every part lies in the solid" : "the parts cover the solid");
  print_row("volume", has_volumes(found) ? fmt::format("{:.6g} of the solid's, summed over the parts",
                                                       found.parts_volume / found.solid_volume)
                                         : "beyond what a double holds");
}

void print_json(const DecomposeArguments& arguments, const Outcome& outcome) {
  const SolidDecomposition& found = outcome.found;
  std::string out;
  query::JsonWriter writer(out);
  writer.begin_object();
  writer.key("input").string(arguments.input);
  writer.key("output").string(arguments.output);
  writer.key("triangles").integer(static_cast<std::int64_t>(outcome.solid.triangles().size()));
  writer.key("side").string(arguments.inside ? "inner" : "outer");
  writer.key("parts").integer(static_cast<std::int64_t>(found.parts.parts().size()));
  writer.key("most_vertices").integer(outcome.most_vertices());
  writer.key("error").number(found.error);
  writer.key("error_asked").number(outcome.asked);
  writer.key("error_reached").boolean(found.error_reached);
  for (const auto& [key, volume] :
       {std::pair("solid_volume", found.solid_volume), std::pair("parts_volume", found.parts_volume)}) {
    has_volumes(found) ? writer.key(key).number(volume) : writer.key(key).null();
  }
  writer.key("stats").begin_object();
  writer.key("steps").integer(found.steps);
  writer.key("nanoseconds").integer(outcome.nanoseconds);
  writer.end_object().end_object();
  fmt::print("{}\n", out);
}

int run_decompose(const DecomposeArguments& arguments) {
  check_outputs({arguments.input}, {{"--output", arguments.output}});
  if (arguments.max_parts < 1) query::refuse("bad_value", "--max-parts: must be 1 or more", "");
  if (arguments.max_steps < 1) query::refuse("bad_value", "--max-steps: must be 1 or more", "");
  Progress progress("reading " + arguments.input);
  query::MeshPoints mesh = read_mesh_argument(arguments.input, kMostMeshPoints);
  const query::SolidWish wish{.always = true,
                              .turn_faces = arguments.turn_faces,
                              .hull_words = "`pdepth simplify`",
                              .turn_words = "--turn-faces",
                              .parts_words = ""};
  const auto solid = query::body_of_mesh(std::move(mesh), arguments.input, wish).solid;
  DecompositionSettings settings;
  settings.error = read_error(arguments.error, diagonal_of(*solid));
  settings.inside = arguments.inside;
  settings.max_parts = arguments.max_parts;
  settings.max_steps = arguments.max_steps;
  progress.begin(fmt::format("cutting {} triangles", solid->triangles().size()));
  settings.watch = [&, told = std::int64_t{-1}](const DecompositionSettings::Progress& now) mutable {
    if (now.parts == told) return;
    told = now.parts;
    progress.begin(fmt::format("{} parts", now.parts));
  };
  const query::Stopwatch watch;
  const auto found = decompose(*solid, settings);
  if (!found) {
    query::refuse(to_string(found.error().code), arguments.input + ": " + found.error().message, "");
  }
  if (!write_whole_file(arguments.output, obj_of(*found, arguments))) {
    return cannot_write({"--output", arguments.output});
  }
  const std::int64_t nanoseconds = watch.nanoseconds();
  progress.end();
  const Outcome outcome{*solid, *found, settings.error, nanoseconds};
  arguments.json ? print_json(arguments, outcome) : print_text(arguments, outcome);
  return found->error_reached ? kDone : kConditionFails;
}

}  // namespace

void add_decompose_command(CLI::App& app, Action& action) {
  auto arguments = std::make_shared<DecomposeArguments>();
  CLI::App* command = app.add_subcommand("decompose", "Convex parts of a closed mesh, with a certified error");
  command->footer(kDecomposeFooter);
  command->add_option("MESH", arguments->input, "A closed mesh: OBJ, STL, PLY, OFF or glTF")->required();
  command->add_option("-o,--output", arguments->output, "The parts, as OBJ with a group for each")
      ->required()
      ->check(refuse_other_meshes, "FILE.obj");
  command
      ->add_option("--error", arguments->error,
                   "The most that parts differ from the solid: a length in the file's unit, or % of the diagonal")
      ->capture_default_str();
  command->add_flag("--inside", arguments->inside,
                    "Parts that lie in the solid, instead of parts that cover the solid");
  command->add_flag("--turn-faces", arguments->turn_faces, "Turns the faces of a mesh that is wholly inside out");
  command->add_flag("--json", arguments->json, "Print one JSON object instead of rows");
  command->add_option("--max-parts", arguments->max_parts, "Ends the work at so many parts")->capture_default_str();
  command
      ->add_option("--max-steps", arguments->max_steps,
                   "Ends the work after so many bounds and pieces of faces, of a microsecond or several each")
      ->capture_default_str();
  command->callback([arguments, &action] { action = [arguments] { return run_decompose(*arguments); }; });
}

}  // namespace pd::cli
