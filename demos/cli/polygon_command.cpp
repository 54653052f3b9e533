/// @file
/// `pdepth polygon P Q`: how far Q must move to come clear of P, in the plane, from drawings or JSON.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "commands.hpp"
#include "drawing/polygon_file.hpp"
#include "options.hpp"
#include "pd/planar/polygon_depth.hpp"
#include "protocol/pair_reader.hpp"
#include "protocol/polygon_answer.hpp"
#include "support/complain.hpp"
#include "usage.hpp"
#ifdef PDEPTH_WITH_DEMOS
#include "support/polygon_picture.hpp"
#endif

namespace pd::cli {

namespace {

constexpr const char* kPolygonFooter =
    R"(P stays and Q moves, as in the paper; everywhere else the first body moves. A file is
  FILE.json     {"outer":[[x,y],...],"holes":[[[x,y],...],...],"margin":r}, in P's unit; holes and margin may be left out.
                A disc of radius r sweeps the polygon; one point with a margin is a disc
  FILE.svg#ID   an element of a drawing: path, rect, circle, ellipse, polygon or polyline, with the transforms above it;
                #ID may be left out where there is one. The inside follows fill-rule; fill and stroke do not matter
Lengths are in the unit of the width of P's page (user units where it has none). In drawings y points down, and nothing is
turned round. Curves become polylines: no point of one lies farther than --flatness from its chord.

Without --direction the least move over all directions is found. With --complete Q shall get away for good:
  --complete=straight  going on straight along the move's own direction, for ever
  --complete=escape    by any motion: Q comes to where a way leads out, not into a hole that it fits in
--complete alone is straight with --direction, escape without.

If Q fits exactly into a hole or a notch, the place has no area and is no way out: the answer says that Q fits, and --seats
lists all such displacements.

Examples:
  pdepth polygon plate.svg tool.json
  pdepth polygon sheet.svg#plate part.svg --direction 0,1 --complete
  pdepth polygon sheet.svg#plate part.svg --complete=straight
  pdepth polygon plate.svg tool.svg --margin 0,0.5     a tool with a clearance of half a unit
  pdepth polygon frame.json peg.json --place-q 2.25,4 --picture out.png)";

struct PolygonArguments {
  std::string file_p;
  std::string file_q;
  std::string direction;
  std::string place;
  std::string picture;
  std::optional<double> flatness;
  std::string complete;         ///< one of the three words below, or nothing
  std::vector<double> margins;  ///< none, one for both, or one each
  bool seats = false;
  bool json = false;
};

constexpr const char* kStraight = "straight";
constexpr const char* kEscape = "escape";
constexpr const char* kByDirection = "true";  ///< --complete without a word: CLI11's value of a flag

struct PolygonPair {
  drawing::PolygonFile p, q;
  Point2 place = {0, 0};
  std::optional<Point2> direction;
  Leave leave = Leave::first_exit;
  PlanarMargins margins = {};
  [[nodiscard]] bool swept() const { return margins.p > 0 || margins.q > 0; }
};

Point2 parse_point(const std::string& text, const std::string& option) {
  const std::vector<double> n = parse_numbers(text, option);
  if (n.size() != 2) {
    query::refuse("bad_value", option + ": two numbers are expected, X,Y, not " + std::to_string(n.size()), "");
  }
  for (const double x : n) {
    if (!std::isfinite(x)) query::refuse("non_finite", option + ": the numbers must be finite", "");
    if (std::abs(x) > 1e300) query::refuse("out_of_range", option + ": the numbers must be at most 1e300", "");
  }
  return {n[0], n[1]};
}

Leave leave_of(const PolygonArguments& arguments) {
  if (arguments.complete.empty()) return Leave::first_exit;
  if (arguments.complete == kByDirection) return arguments.direction.empty() ? Leave::escape : Leave::straight;
  return arguments.complete == kStraight ? Leave::straight : Leave::escape;
}

PolygonPair read_pair(const PolygonArguments& arguments) {
  const query::Limits limits{.max_vertices = 10'000'000};
  drawing::PolygonFile p = drawing::read_polygon_file(arguments.file_p, arguments.flatness, "", limits);
  drawing::PolygonFile q = drawing::read_polygon_file(arguments.file_q, arguments.flatness, p.unit, limits);
  PolygonPair pair{std::move(p), std::move(q), {0, 0}, std::nullopt, Leave::first_exit, {}};
  if (!arguments.place.empty()) pair.place = parse_point(arguments.place, "--place-q");
  if (!arguments.direction.empty()) {
    pair.direction = parse_point(arguments.direction, "--direction");
    if (*pair.direction == Point2{0, 0}) query::refuse("zero_direction", "--direction must not be 0,0", "");
  }
  pair.leave = leave_of(arguments);
  // A file's own disc and that of the option sweep one after the other.
  const std::vector<double>& margins = arguments.margins;
  pair.margins = {pair.p.margin + (margins.empty() ? 0 : margins.front()),
                  pair.q.margin + (margins.empty() ? 0 : margins.back())};
  if (pair.swept() && !arguments.picture.empty()) {
    query::refuse("unsupported", "--picture is for polygons without a margin", "");
  }
  if (pair.swept() && arguments.seats) {
    query::refuse("unsupported", "--seats is for polygons without a margin", "");
  }
  return pair;
}

PolygonDepth answer_of(const PolygonPair& pair, const PolygonDifference& r) {
  if (pair.swept()) {
    const Expected<PolygonDepth> found =
        pair.direction ? r.swept_depth_along(pair.place, *pair.direction, pair.margins, pair.leave)
                       : r.swept_depth(pair.place, pair.margins, pair.leave);
    if (!found) query::refuse(to_string(found.error().code), found.error().message, found.error().where);
    return *found;
  }
  if (pair.direction) return r.depth_along(pair.place, *pair.direction, pair.leave);
  switch (pair.leave) {
    case Leave::straight:
      return r.straight_escape_depth(pair.place);
    case Leave::escape:
      return r.escape_depth(pair.place);
    case Leave::first_exit:
      break;
  }
  return r.depth(pair.place);
}

// ---- words for people --------------------------------------------------------------------------------------------

void print_polygon(std::string_view name, const std::string& file, const drawing::PolygonFile& polygon, double margin) {
  const int holes = polygon.polygon.num_rings() - 1;
  int vertices = 0;  // without the points where another ring touches an edge
  for (int v = 0; v < polygon.polygon.num_vertices(); ++v) {
    vertices += polygon.polygon.caller_id(v).ring == polygon.polygon.caller_edge(v).ring ? 1 : 0;
  }
  std::string words = fmt::format("{}  ({} vertices", file, vertices);
  if (polygon.polygon.is_point()) words = file + "  (a point";
  if (holes > 0) words += fmt::format(", {} {}", holes, holes == 1 ? "hole" : "holes");
  if (polygon.polygon.convex() && !polygon.polygon.is_point()) words += ", convex";
  if (margin > 0) words += fmt::format(", swept by a disc of radius {:.10g}", margin);
  if (polygon.flatness > 0) {
    words += fmt::format("; curves within {:.3g}{}{}", polygon.flatness, polygon.unit.empty() ? "" : " ", polygon.unit);
  }
  print_row(name, words + ")");
}

std::string feature_in_words(const Polygon& polygon, const Polygon::VertexId& id, bool edge) {
  const std::string ring = id.ring < 0 ? "outer" : fmt::format("holes[{}]", id.ring);
  for (int v = 0; v < polygon.num_vertices(); ++v) {
    if (!((edge ? polygon.caller_edge(v) : polygon.caller_id(v)) == id)) continue;
    const Point2 &a = polygon.point(v), &b = polygon.point(polygon.next(v));
    if (!edge) return fmt::format("vertex {}[{}] ({:.10g}, {:.10g})", ring, id.index, a[0], a[1]);
    return fmt::format("edge at {}[{}], ({:.10g}, {:.10g}) to ({:.10g}, {:.10g})", ring, id.index, a[0], a[1], b[0],
                       b[1]);
  }
  return fmt::format("{} {}[{}]", edge ? "edge" : "vertex", ring, id.index);
}

/// What the answer says, in one line.
std::string verdict(const PolygonPair& pair, const PolygonDepth& result, bool seat) {
  const std::string way = pair.direction ? " along the direction" : "";
  if (seat && pair.leave == Leave::first_exit) {
    return "Q fits exactly where it is: no insides meet, but it cannot leave without overlap; this moves Q clear" +
           way + ".";
  }
  if (pair.leave == Leave::straight) {
    if (result.depth == 0) {
      return pair.direction ? "Nothing is in Q's way along the direction." : "Q can leave straight as it is.";
    }
    return pair.direction ? "Q must go this far before nothing is in its way any more."
                          : "Straight on in this direction nothing is in Q's way after the least such move.";
  }
  if (pair.leave == Leave::escape) {
    return result.depth == 0 ? "Q can leave as it is." : "After the least such move" + way + " a way leads Q out of P.";
  }
  switch (result.contact) {
    case PlanarContact::overlapping:
      return "P and Q overlap; this moves Q clear of P" + way + ".";
    case PlanarContact::touching:
      return "P and Q touch: they share boundary points, but no inside.";
    case PlanarContact::separated:
      break;
  }
  return "P and Q are apart.";
}

/// The places where Q fits exactly, the first ten of each kind.
void print_seats(const PolygonDifference::Seats& seats) {
  constexpr std::size_t kMost = 10;
  const auto row = [](const std::string& words) { print_row("fits at", words); };
  for (std::size_t i = 0; i < std::min(kMost, seats.points.size()); ++i) {
    row(fmt::format("({:.10g}, {:.10g})", seats.points[i][0], seats.points[i][1]));
  }
  for (std::size_t i = 0; i < std::min(kMost, seats.slots.size()); ++i) {
    const auto& [a, b] = seats.slots[i];
    row(fmt::format("({:.10g}, {:.10g}) to ({:.10g}, {:.10g}), a slot", a[0], a[1], b[0], b[1]));
  }
  const std::size_t all = seats.points.size() + seats.slots.size();
  if (all == 0) row("no displacement of Q exactly");
  if (std::max(seats.points.size(), seats.slots.size()) > kMost) row(fmt::format("{} places in all", all));
}

void print_result(const PolygonArguments& arguments, const PolygonPair& pair, const PolygonDifference& r,
                  const PolygonDepth& result, std::int64_t nanoseconds) {
  const std::string unit = pair.p.unit.empty() ? "" : " " + pair.p.unit;
  fmt::print("\n");
  print_polygon("P", arguments.file_p, pair.p, pair.margins.p);
  print_polygon("Q", arguments.file_q, pair.q, pair.margins.q);
  fmt::print("\n{}\n\n", verdict(pair, result, !pair.swept() && r.seat(pair.place)));
  print_row("depth", fmt::format("{}{}", result.depth, unit));
  if (result.depth > 0) {
    print_row("bracket", fmt::format("[{}, {}]", result.lower, result.upper));
    print_row("translation", fmt::format("({:.10g}, {:.10g})  moves Q, P stays", result.translation[0] + 0.0,
                                         result.translation[1] + 0.0));
  }
  if (result.normal != Point2{0, 0}) {
    print_row("direction", fmt::format("({:.10g}, {:.10g})", result.normal[0] + 0.0, result.normal[1] + 0.0));
  }
  if (result.feature) {
    print_row("of P", feature_in_words(pair.p.polygon, result.feature->p, result.feature->p_edge));
    print_row("of Q", feature_in_words(pair.q.polygon, result.feature->q, result.feature->q_edge));
  }
  if (arguments.seats) print_seats(r.seats());
  const PolygonDifference::Statistics s = r.statistics();
  fmt::print("\n");
  print_row("method", fmt::format("{}: {} convex sums, {} pieces of boundary, {} {}, {}",
                                  s.implicit ? "implicit" : "explicit", s.sums, s.stretches, s.loops - 1,
                                  s.loops == 2 ? "hole" : "holes", duration_in_words(nanoseconds)));
  fmt::print("\n");
}

int draw_picture(const PolygonArguments& arguments, const PolygonPair& pair, const PolygonDifference& r,
                 const PolygonDepth& result) {
#ifdef PDEPTH_WITH_DEMOS
  return demo::write_polygon_picture({&pair.p.polygon, &pair.q.polygon, pair.place, pair.p.unit, pair.p.drawing}, r,
                                     result, verdict(pair, result, !pair.swept() && r.seat(pair.place)),
                                     arguments.picture);
#else
  (void)pair;
  (void)r;
  (void)result;
  return refuse_picture(arguments.picture);
#endif
}

/// FILE.svg of FILE.svg#ID.
std::string file_of(const std::string& argument) { return argument.substr(0, argument.rfind('#')); }

int run_polygon(const PolygonArguments& arguments) {
  check_outputs({file_of(arguments.file_p), file_of(arguments.file_q)}, {{"--picture", arguments.picture}});
  const PolygonPair pair = read_pair(arguments);
  const query::Stopwatch watch;
  const Expected<PolygonDifference> r = PolygonDifference::of(pair.p.polygon, pair.q.polygon);
  if (!r) query::refuse(to_string(r.error().code), r.error().message, r.error().where);
  const PolygonDepth result = answer_of(pair, *r);
  const std::int64_t nanoseconds = watch.nanoseconds();
  if (arguments.json) {
    std::string out;
    query::JsonWriter writer(out);
    writer.begin_object();
    const std::vector<bool> seats = pair.swept() ? std::vector<bool>() : std::vector<bool>{r->seat(pair.place)};
    query::write_polygon_answers({result}, seats, false, writer);
    if (arguments.seats) query::write_seats(r->seats(), writer);
    query::write_polygon_statistics(*r, nanoseconds, writer);
    writer.end_object();
    fmt::print("{}\n", out);
  } else {
    print_result(arguments, pair, *r, result, nanoseconds);
  }
  return arguments.picture.empty() ? kDone : draw_picture(arguments, pair, *r, result);
}

}  // namespace

void add_polygon_command(CLI::App& app, Action& action) {
  auto arguments = std::make_shared<PolygonArguments>();
  CLI::App* command = app.add_subcommand("polygon", "How far one polygon must move to leave another, in the plane");
  command->footer(kPolygonFooter);
  command->add_option("P", arguments->file_p, "Polygon that stays: FILE.svg, FILE.svg#ID or FILE.json")->required();
  command->add_option("Q", arguments->file_q, "Polygon that moves (elsewhere the first body moves)")->required();
  command->add_option("--direction", arguments->direction, "Move along X,Y [the best direction]");
  // A flag, so that a file may follow --complete alone; a word comes behind "=".
  command
      ->add_flag("--complete", arguments->complete,
                 "Get away for good, not only clear of P: --complete=straight or --complete=escape")
      ->check([words = one_of({kStraight, kEscape})](
                  const std::string& word) { return word == kByDirection ? std::string() : words(word); },
              fmt::format("{{{},{}}}", kStraight, kEscape))
      ->option_text("or --complete=WORD");
  command->add_option("--place-q", arguments->place, "Displacement X,Y of Q before it is looked at [0,0]");
  command
      ->add_option("--flatness", arguments->flatness, "Greatest distance of a curve from its chords [1e-4 of the size]")
      ->check(number_above_zero());
  command->add_option("--picture", arguments->picture, "Draw P, Q and all forbidden placements as a PNG")
      ->check(refuse_other_pictures, "FILE.png");
  command->add_option("--margin", arguments->margins, "Radius of a disc that sweeps both polygons, or two for P,Q")
      ->delimiter(',')
      ->expected(1, 2)
      ->check(number_of_zero_or_more());
  command->add_flag("--seats", arguments->seats, "List the displacements at which Q fits exactly: points and slots");
  command->add_flag("--json", arguments->json, "Print one JSON object, as `pdepth query` answers polygon_depth");
  command->callback([arguments, &action] { action = [arguments] { return run_polygon(*arguments); }; });
}

}  // namespace pd::cli
