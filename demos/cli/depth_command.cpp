/// @file
/// `pdepth depth A B`: two bodies, answered for people or, with --json, for programs.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "body_argument.hpp"
#include "commands.hpp"
#include "options.hpp"
#include "pd/depth/directional_depth.hpp"
#include "pd/numeric/whole_file.hpp"
#include "progress.hpp"
#include "protocol/pair_reader.hpp"
#include "protocol/search_file.hpp"
#include "protocol/solid_queries.hpp"
#include "protocol/union_queries.hpp"
#include "support/complain.hpp"
#include "usage.hpp"
#ifdef PDEPTH_WITH_DEMOS
#include "difference.hpp"
#endif

namespace pd::cli {

namespace {

constexpr const char* kDepthFooter =
    R"(
Poses: x,y,z moves; x,y,z,qw,qx,qy,qz also turns (a unit quaternion, scalar first);
x,y,z,r11,r12,r13,r21,...,r33 turns by a matrix. World point = R * point + (x,y,z).

A moves by the translation, B stays. A closed mesh that is not convex is asked as the solid that it bounds; --hull asks
for the convex hull of its vertices instead, and the answer says so; --parts asks for the union of the file's parts: the
groups of an OBJ (o, g), or the meshes of a glTF. A mesh with holes bounds no solid and is refused; `pdepth check FILE`
tells every fault.

Examples:
  pdepth depth box:1,1,1 sphere:0.5 --pose-b 1.25,0,0
  pdepth depth cup.obj box:0.4,0.4,0.02 --margin 0.001 --direction 0,0,1
  pdepth depth cup.obj table.stl --pose-a 0,0,0.74
  pdepth depth a.off b.off --pose-b=-1.5,0,0,0.7071067811865476,0,0,0.7071067811865476 --json)";

struct DepthArguments {
  std::string file_a;
  std::string file_b;
  std::string pose_a = "0,0,0";
  std::string pose_b = "0,0,0";
  std::string direction;
  std::vector<double> margins;  ///< none, one for both, or one each
  std::string method = "auto";
  double delta = 0.25;
  std::string picture;
  std::string trace;
  bool json = false;
  bool hull = false;
  bool parts = false;
};

Pose parse_pose(const std::string& text, const std::string& option) {
  const std::vector<double> n = parse_numbers(text, option);
  const auto pose = [&]() -> Expected<Pose> {
    if (n.size() == 3) return Pose::from_matrix(Mat3::Identity(), {n[0], n[1], n[2]});
    if (n.size() == 7) return Pose::from_quaternion({n[3], n[4], n[5], n[6]}, {n[0], n[1], n[2]});
    if (n.size() == 12) {
      Mat3 rotation;
      for (int i = 0; i < 9; ++i) rotation(i / 3, i % 3) = n[static_cast<std::size_t>(3 + i)];
      return Pose::from_matrix(rotation, {n[0], n[1], n[2]});
    }
    constexpr const char* kRight =
        "x,y,z with no rotation, a quaternion or a matrix: 3, 7 or 12 numbers between commas";
    query::refuse("bad_value", fmt::format("{}: a pose is {}, not {}", option, kRight, n.size()), "");
  }();
  if (!pose) {
    query::refuse(to_string(pose.error().code),
                  fmt::format("{}: {}{}", option, pose.error().message,
                              n.size() == 7 ? "; seven numbers are x,y,z and a unit quaternion w,x,y,z" : ""),
                  "");
  }
  return *pose;
}

constexpr Method kMethods[] = {Method::automatic,     Method::expansion, Method::overlay,
                               Method::decomposition, Method::shallow,   Method::grid};

std::vector<std::string> method_words() {
  std::vector<std::string> words;
  for (const Method method : kMethods) words.emplace_back(to_string(method));
  return words;
}

/// Requires one of `method_words`.
Method parse_method(const std::string& word) {
  return *std::find_if(std::begin(kMethods), std::end(kMethods), [&](Method m) { return to_string(m) == word; });
}

/// The exact methods are within every delta.
DepthSettings settings_of(const DepthArguments& arguments) {
  DepthSettings settings{.method = parse_method(arguments.method)};
  if (settings.method == Method::grid || settings.method == Method::shallow) settings.delta = arguments.delta;
  return settings;
}

/// Prints one JSON object, whose members `fill` writes.
template <class Fill>
int print_object(const Fill& fill) {
  std::string out;
  query::JsonWriter writer(out);
  writer.begin_object();
  fill(writer);
  writer.end_object();
  fmt::print("{}\n", out);
  return kDone;
}

// ---- words for people --------------------------------------------------------------------------------------------

std::string in_words(double value) { return fmt::format("{:.10g}", value + 0.0); }
std::string in_full(double value) { return fmt::format("{}", value); }
std::string in_words(const Vec3& v) {
  return fmt::format("({:>14}, {:>14}, {:>14})", in_words(v.x()), in_words(v.y()), in_words(v.z()));
}

std::string feature_in_words(const Feature& feature, const query::NamedShape& shape) {
  const std::vector<int> ids = query::feature_ids(feature, shape);
  constexpr std::size_t kShown = 6;
  std::string list;
  for (std::size_t i = 0; i < std::min(ids.size(), kShown); ++i) list += fmt::format("{}{}", i ? ", " : "", ids[i]);
  if (ids.size() > kShown) list += fmt::format(", ... {} in all", ids.size());
  return feature.kind == Feature::Kind::vertex  ? "vertex " + list
         : feature.kind == Feature::Kind::edge  ? "edge " + list
         : feature.kind == Feature::Kind::facet ? "facet " + list
                                                : "none";
}

std::string label(const std::string& word) { return word == "-" ? "standard input" : word; }

void print_body(std::string_view name, const std::string& word, const query::NamedShape& shape) {
  std::string facts;
  // A sphere is a point that is swept, and a capsule a segment.
  if (const ConvexPolytope* const hull = shape.shape.polytope(); hull != nullptr && hull->num_facets() > 0) {
    facts = fmt::format("  (hull: {} vertices, {} edges, {} facets)", hull->num_vertices(), hull->num_edges(),
                        hull->num_facets());
  }
  print_row(name, label(word) + facts);
  if (shape.hull_note) print_row("", in_words(*shape.hull_note));
}

/// "A's hull and B": what the answer is about.
std::string subjects(const query::Pair& pair) {
  return std::string(pair.a.hull_note ? "A's hull" : "A") + " and " + (pair.b.hull_note ? "B's hull" : "B");
}

void print_sentence(const std::string& who, ContactClass contact) {
  const char* const words = contact == ContactClass::overlapping ? "overlap"
                            : contact == ContactClass::touching  ? "touch: they share boundary points, but no inside"
                                                                 : "are apart";
  fmt::print("\n{} {}.\n\n", who, words);
}

/// The bodies, and in one sentence how they lie.
void print_pair(const DepthArguments& arguments, const query::Pair& pair, ContactClass contact) {
  fmt::print("\n");
  print_body("A", arguments.file_a, pair.a);
  print_body("B", arguments.file_b, pair.b);
  print_sentence(subjects(pair), contact);
}

void print_statistics(std::string_view method, const Statistics& statistics, std::int64_t nanoseconds) {
  fmt::print("\n");
  print_row("method",
            fmt::format("{}, {} support calls, {} facets, {} exact decisions, {}", method, statistics.support_calls,
                        statistics.facets_visited, statistics.exact_signs, duration_in_words(nanoseconds)));
  fmt::print("\n");
}

void print_answer(const PenetrationDepth& result, std::string_view touching = "a way out for A") {
  switch (result.contact) {
    case ContactClass::overlapping:
      print_row("depth", in_full(result.depth) + (result.bracket_reached ? "" : "  at most; the bracket is wide"));
      print_row("bracket", fmt::format("[{}, {}]", in_full(result.lower), in_full(result.upper)));
      print_row("translation", in_words(result.translation) + "  moves A clear of B");
      print_row("direction", in_words(result.normal));
      break;
    case ContactClass::touching:
      print_row("depth", "0, exactly");
      print_row("direction", fmt::format("{}  {}", in_words(result.normal), touching));
      break;
    case ContactClass::separated:
      print_row("distance", in_full(result.distance));
      print_row("bracket", fmt::format("[{}, {}]", in_full(result.distance_lower), in_full(result.distance_upper)));
      print_row("direction", in_words(result.normal) + "  from B to A");
      break;
  }
  print_row("point on A", in_words(result.witness_a));
  print_row("point on B", in_words(result.witness_b));
}

void print_result(const DepthArguments& arguments, const query::Pair& pair, const PenetrationDepth& result,
                  std::int64_t nanoseconds) {
  print_pair(arguments, pair, result.contact);
  print_answer(result);
  if (!query::feature_kind(result).empty()) {
    print_row("of A", feature_in_words(result.feature_a, pair.a));
    print_row("of B", feature_in_words(result.feature_b, pair.b));
  }
  print_statistics(to_string(result.method), result.statistics, nanoseconds);
}

int draw_picture(const DepthArguments& arguments, [[maybe_unused]] const query::Pair& pair,
                 [[maybe_unused]] const PenetrationDepth& result) {
#ifdef PDEPTH_WITH_DEMOS
  return demo::write_difference_picture(
      {&pair.a.shape, &pair.b.shape, pair.pose_a, pair.pose_b, arguments.file_a, arguments.file_b}, result,
      arguments.picture);
#else
  return refuse_picture(arguments.picture);
#endif
}

/// @return an exit code
int write_trace(const std::string& file, const query::SearchRecorder& recorder) {
  if (!write_whole_file(file, recorder.lines())) return cannot_write({"--trace", file});
  if (recorder.steps() == 0) complain("no polytope was expanded: {} holds no steps (try --method expansion)", file);
  return kDone;
}

/// Both are for two polytopes without margins.
void require_polytopes(const query::Pair& pair, const std::string& option) {
  const auto bare = [](const ConvexShape& shape) { return shape.polytope() != nullptr && shape.margin() == 0; };
  if (!bare(pair.a.shape) || !bare(pair.b.shape)) {
    query::refuse("unsupported", option + ": both bodies must be meshes or boxes, without a margin", "");
  }
}

/// A and B with their margins.
std::pair<BodyArgument, BodyArgument> bodies_of(const DepthArguments& arguments) {
  if (arguments.file_a == "-" && arguments.file_b == "-") {
    query::refuse("bad_value", "A and B: standard input holds one mesh, so only one of them may be -", "");
  }
  const query::MeshAs as = arguments.hull ? query::MeshAs::hull : query::MeshAs::found;
  return {{arguments.file_a, arguments.margins.empty() ? 0 : arguments.margins.front(), as},
          {arguments.file_b, arguments.margins.empty() ? 0 : arguments.margins.back(), as}};
}

query::Pair read_pair(const DepthArguments& arguments) {
  const auto [a, b] = bodies_of(arguments);
  return {read_body_argument(a), read_body_argument(b), parse_pose(arguments.pose_a, "--pose-a"),
          parse_pose(arguments.pose_b, "--pose-b")};
}

/// --direction: how far A must move that way.
int run_along(const DepthArguments& arguments, const query::Pair& pair, Progress& progress) {
  const std::vector<double> n = parse_numbers(arguments.direction, "--direction");
  if (n.size() != 3) {
    query::refuse("bad_value", fmt::format("--direction: three numbers are expected, X,Y,Z, not {}", n.size()), "");
  }
  const Vec3 direction(n[0], n[1], n[2]);
  Scratch scratch;
  const query::Stopwatch watch;
  const auto result = directional_depth(pair.posed_a(), pair.posed_b(), direction, scratch);
  if (!result) query::refuse(to_string(result.error().code), "--direction: " + result.error().message, "");
  const std::int64_t nanoseconds = watch.nanoseconds();
  progress.end();
  if (arguments.json) {
    return print_object([&](auto& writer) { query::write_directional_answer(*result, nanoseconds, writer); });
  }
  print_pair(arguments, pair, result->contact);
  print_row("depth", in_full(result->depth) + "  along the direction");
  print_row("bracket", fmt::format("[{}, {}]", in_full(result->lower), in_full(result->upper)));
  if (result->contact == ContactClass::overlapping) {
    print_row("translation", in_words(Vec3(direction.stableNormalized() * result->depth)) + "  moves A clear of B");
  }
  print_statistics("portal", result->statistics, nanoseconds);
  return kDone;
}

// ---- solids ------------------------------------------------------------------------------------------------------

/// A mesh as a solid; a polytope is one, too, and other shapes stand beside it.
struct SolidBody {
  std::shared_ptr<const MeshSolid> solid;
  std::optional<ConvexShape> shape;
  bool convex = false;

  [[nodiscard]] query::SolidOrShape posed(const Pose& pose) const {
    return {solid.get(), shape ? &*shape : nullptr, pose};
  }
};

SolidBody solid_of(const std::shared_ptr<const MeshSolid>& loaded, const BodyArgument& argument) {
  if (loaded && argument.margin > 0) {
    query::refuse("unsupported", argument.word + ": a solid takes no margin here; --hull asks for the hulls", "");
  }
  if (loaded) return {loaded, {}, false};
  const query::NamedShape shape = read_body_argument(argument);
  if (shape.shape.polytope() == nullptr || shape.shape.margin() > 0) return {{}, shape.shape, true};
  auto solid = MeshSolid::from_polytope(*shape.shape.polytope());
  if (!solid) query::refuse(to_string(solid.error().code), argument.word + ": " + solid.error().message, "");
  return {std::make_shared<const MeshSolid>(*std::move(solid)), {}, true};
}

void print_body(std::string_view name, const std::string& word, const SolidBody& body) {
  if (!body.solid) return print_row(name, label(word));
  print_row(name,
            fmt::format("{}  ({}: {} vertices, {} triangles{})", label(word), body.convex ? "convex" : "solid",
                        body.solid->vertices().size(), body.solid->triangles().size(),
                        body.solid->num_shells() > 1 ? fmt::format(", {} shells", body.solid->num_shells()) : ""));
}

void print_solids(const DepthArguments& arguments, const SolidBody& a, const SolidBody& b, const SolidDepth& result,
                  std::int64_t nanoseconds, bool fits_exactly) {
  fmt::print("\n");
  print_body("A", arguments.file_a, a);
  print_body("B", arguments.file_b, b);
  print_sentence("A and B", result.contact);
  print_answer(result, "across a place where they touch, towards A");
  if (fits_exactly) print_row("seat", "A fits exactly: it can only slide, if it can move at all");
  if (result.face_a >= 0) print_row("of A", fmt::format("face {}", result.face_a));
  if (result.face_b >= 0) print_row("of B", fmt::format("face {}", result.face_b));
  fmt::print("\n");
  print_row("method", fmt::format("solid, {} tests of triangles, {} by {} convex parts, {} points, {}",
                                  result.work.triangle_pairs, result.work.parts_a, result.work.parts_b,
                                  result.work.points, duration_in_words(nanoseconds)));
  fmt::print("\n");
}

int run_solids(const DepthArguments& arguments, const SolidBody& a, const SolidBody& b, Progress& progress) {
  if (arguments.method != "auto") query::refuse("unsupported", "--method: solids are answered by auto", "");
  if (!(arguments.picture + arguments.trace + arguments.direction).empty()) {
    query::refuse("unsupported", "--picture, --trace and --direction need convex bodies; --hull asks for the hulls",
                  "");
  }
  const Pose pose_a = parse_pose(arguments.pose_a, "--pose-a"), pose_b = parse_pose(arguments.pose_b, "--pose-b");
  Scratch scratch;
  progress.begin("depth beside a solid");
  const PosedSolid posed_a{a.solid.get(), pose_a}, posed_b{b.solid.get(), pose_b};
  const query::Stopwatch watch;
  const auto found = query::depth_beside_solid(a.posed(pose_a), b.posed(pose_b), scratch);
  const std::int64_t nanoseconds = watch.nanoseconds();
  if (!found) query::refuse(to_string(found.error().code), found.error().message, "");
  const SolidDepth& result = *found;
  const bool may_sit = result.contact == ContactClass::touching && a.solid && b.solid;
  progress.end();
  if (!arguments.json) {
    const Expected<bool> seat = may_sit ? is_seat(posed_a, posed_b) : false;
    print_solids(arguments, a, b, result, nanoseconds, seat && *seat);
    return kDone;
  }
  return print_object([&](auto& writer) {
    query::write_solid_answer(result, nanoseconds, writer);
    if (may_sit) query::write_seat(posed_a, posed_b, writer);
    if (!a.convex) writer.key("a_is").string("solid");
    if (!b.convex) writer.key("b_is").string("solid");
  });
}

// ---- parts -------------------------------------------------------------------------------------------------------

void print_parts(const DepthArguments& arguments, const query::BodyPair& pair, const UnionDepth& result,
                 std::int64_t nanoseconds) {
  const auto print_union = [](std::string_view name, const std::string& word, const query::NamedBody& body) {
    print_row(name, fmt::format("{}  (convex parts: {})", label(word), body.parts.size()));
  };
  fmt::print("\n");
  print_union("A", arguments.file_a, pair.a);
  print_union("B", arguments.file_b, pair.b);
  print_sentence("A and B", result.contact);
  print_answer(result);
  if (!query::feature_kind(result).empty()) {
    const auto part = [](const query::NamedBody& body, int index, const Feature& feature) {
      return fmt::format("{} of convex part {}", feature_in_words(feature, body.parts[static_cast<std::size_t>(index)]),
                         index);
    };
    print_row("of A", part(pair.a, result.part_a, result.feature_a));
    print_row("of B", part(pair.b, result.part_b, result.feature_b));
  }
  print_statistics(to_string(result.method), result.statistics, nanoseconds);
}

/// --parts: the groups of files as unions.
int run_parts(const DepthArguments& arguments, Progress& progress) {
  if (arguments.method != "auto" || !(arguments.picture + arguments.trace + arguments.direction).empty()) {
    query::refuse("unsupported", "--parts takes neither --method nor --picture, --trace and --direction", "");
  }
  const auto [a, b] = bodies_of(arguments);
  const query::BodyPair pair{read_parts_argument(a), read_parts_argument(b), parse_pose(arguments.pose_a, "--pose-a"),
                             parse_pose(arguments.pose_b, "--pose-b")};
  Scratch scratch;
  progress.begin(fmt::format("depth of unions of {} and {} convex parts", pair.a.parts.size(), pair.b.parts.size()));
  const query::Stopwatch watch;
  const auto result = penetration_depth(pair.posed_a(), pair.posed_b(), scratch, UnionSettings());
  if (!result) query::refuse(to_string(result.error().code), result.error().message, "");
  const std::int64_t nanoseconds = watch.nanoseconds();
  progress.end();
  if (!arguments.json) {
    print_parts(arguments, pair, *result, nanoseconds);
    return kDone;
  }
  return print_object([&](auto& writer) {
    query::write_union_answer(*result, pair, nanoseconds, writer);
    if (names_mesh(arguments.file_a)) writer.key("a_is").string("parts");
    if (names_mesh(arguments.file_b)) writer.key("b_is").string("parts");
  });
}

int run_depth(const DepthArguments& arguments) {
  check_outputs({arguments.file_a, arguments.file_b}, {{"--trace", arguments.trace}, {"--picture", arguments.picture}});
  Progress progress(fmt::format("reading {} and {}", arguments.file_a, arguments.file_b));
  if (arguments.parts) return run_parts(arguments, progress);
  if (!arguments.hull && !(arguments.file_a == "-" && arguments.file_b == "-")) {
    const auto solid_a = read_solid_argument(arguments.file_a), solid_b = read_solid_argument(arguments.file_b);
    if (solid_a || solid_b) {
      const auto [a, b] = bodies_of(arguments);
      return run_solids(arguments, solid_of(solid_a, a), solid_of(solid_b, b), progress);
    }
  }
  const query::Pair pair = read_pair(arguments);
  if (!arguments.picture.empty()) require_polytopes(pair, "--picture");
  if (!arguments.direction.empty()) return run_along(arguments, pair, progress);
  const DepthSettings settings = settings_of(arguments);
  if (!supports(settings.method, pair.a.shape, pair.b.shape)) {
    query::refuse("unsupported",
                  fmt::format("--method: \"{}\" does not answer for these shapes; auto does", arguments.method), "");
  }
  Scratch scratch;
  std::optional<query::SearchRecorder> recorder;
  if (!arguments.trace.empty()) {
    require_polytopes(pair, "--trace");
    observe_searches(scratch, &recorder.emplace(pair, arguments.method));
  }
  progress.begin("depth");
  const query::Stopwatch watch;
  const PenetrationDepth result = penetration_depth(pair.posed_a(), pair.posed_b(), scratch, settings);
  const std::int64_t nanoseconds = watch.nanoseconds();
  progress.end();
  if (recorder) {
    recorder->add_answer(result, pair, nanoseconds);
    if (const int code = write_trace(arguments.trace, *recorder); code != kDone) return code;
  }
  if (arguments.json) {
    print_object([&](auto& writer) {
      query::write_depth_answer(result, pair.a, pair.b, nanoseconds, writer);
      query::write_hull_note("a", pair.a, writer);
      query::write_hull_note("b", pair.b, writer);
    });
  } else {
    print_result(arguments, pair, result, nanoseconds);
  }
  return arguments.picture.empty() ? kDone : draw_picture(arguments, pair, result);
}

}  // namespace

void add_depth_command(CLI::App& app, Action& action) {
  auto arguments = std::make_shared<DepthArguments>();
  CLI::App* command = app.add_subcommand("depth", "Penetration depth (or distance) of two bodies");
  command->footer(kBodyWords + std::string(kDepthFooter));
  command->add_option("A", arguments->file_a, "Body that moves: a mesh's file, - or a primitive as box:1,1,1")
      ->required();
  command->add_option("B", arguments->file_b, "Body that stays")->required();
  command->add_option("--pose-a", arguments->pose_a, "Where A stands [the identity]");
  command->add_option("--pose-b", arguments->pose_b, "Where B stands [the identity]");
  command->add_option("--margin", arguments->margins, "Radius of a ball that sweeps both bodies, or two for A,B")
      ->delimiter(',')
      ->expected(1, 2)
      ->check(number_of_zero_or_more());
  CLI::Option* const direction =
      command->add_option("--direction", arguments->direction, "How far A must move along X,Y,Z [the best direction]");
  command->add_option("--method", arguments->method, "How the search is made; the exact methods give one answer")
      ->check(one_of(method_words()))
      ->capture_default_str();
  command->add_option("--delta", arguments->delta, "grid: relative error; shallow: balance of rays and facets")
      ->check(number_between(1e-6, 1.0))
      ->capture_default_str();
  command->add_option("--picture", arguments->picture, "Draw the pair and its Minkowski difference as a PNG")
      ->check(refuse_other_pictures, "FILE.png");
  command->add_option("--trace", arguments->trace,
                      "Write the search step by step, as JSON lines (`pdepth demo difference --trace` draws them)");
  CLI::Option* const hull =
      command->add_flag("--hull", arguments->hull, "Ask for the convex hulls of the vertices, not for solids");
  command->add_flag("--parts", arguments->parts, "Ask for the unions of the files' groups, each convex or a solid")
      ->excludes(hull);
  command->add_flag("--json", arguments->json, "Print one JSON object, as `pdepth query` answers");
  for (const char* other : {"--method", "--trace", "--picture"}) direction->excludes(command->get_option(other));
  command->callback([arguments, &action] { action = [arguments] { return run_depth(*arguments); }; });
}

}  // namespace pd::cli
