/// @file
/// `pdepth simplify SCAN -o HULL.obj`: a dense scan in, a convex hull of few vertices with a stated error out.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "body_argument.hpp"
#include "commands.hpp"
#include "mesh/mesh_file.hpp"
#include "options.hpp"
#include "pd/dimension/approximate_body.hpp"
#include "pd/numeric/whole_file.hpp"
#include "pd/shape/convex_polytope.hpp"
#include "progress.hpp"
#include "protocol/line/limits.hpp"
#include "protocol/pair_reader.hpp"
#include "support/complain.hpp"
#include "support/refusal.hpp"
#include "usage.hpp"
#ifdef PDEPTH_WITH_DEMOS
#include "support/simplify_picture.hpp"
#endif

namespace pd::cli {

namespace {

constexpr const char* kSimplifyFooter = R"(The result is convex, and lies on one side of the scan's convex hull:
  outer  encloses every point; along no direction does it stick out by more than epsilon / 2 of the scan's extent
  inner  is enclosed, its vertices are points of the scan; every extent is at least (1 - epsilon) of the scan's

Examples:
  pdepth simplify scan.ply --epsilon 1e-3 -o hull.obj
  pdepth simplify scan.stl --epsilon 0.02 --side inner -o inside.obj --picture before_after.png)";

struct SimplifyArguments {
  std::string input;
  std::string output;
  std::string side = "outer";
  std::string picture;
  double epsilon = 1e-3;
};

constexpr std::int64_t kMostPoints = 200'000'000;

/// How far the scan sticks out of the hull (outer) or the hull out of the scan's extent: measured, as a check on what
/// is promised, along the hull's facet normals.
struct Excess {
  double scan_outside = 0;  ///< of the scan's points beyond a facet
  double largest_gap = 0;   ///< between a facet and the scan's nearest point below it
};

Excess measure(const ConvexPolytope& hull, const std::vector<Vec3>& points) {
  Excess r;
  for (int f = 0; f < hull.num_facets(); ++f) {
    const Vec3& normal = hull.facet_normal(f);
    const double offset = normal.dot(hull.vertex(hull.facet_vertices(f)[0]));
    double most = -1e300;
    for (const Vec3& p : points) most = std::max(most, normal.dot(p));
    r.scan_outside = std::max(r.scan_outside, most - offset);
    r.largest_gap = std::max(r.largest_gap, offset - most);
  }
  return r;
}

bool write_obj(const ConvexPolytope& hull, const SimplifyArguments& arguments) {
  std::string text = fmt::format("# convex hull of {}, {}, epsilon {}\n", printable(arguments.input), arguments.side,
                                 arguments.epsilon);
  const auto out = std::back_inserter(text);
  for (int v = 0; v < hull.num_vertices(); ++v) {
    const Vec3 p = hull.vertex(v);
    fmt::format_to(out, "v {} {} {}\n", p.x(), p.y(), p.z());
  }
  for (int f = 0; f < hull.num_facets(); ++f) {
    text += "f";
    for (const std::int32_t v : hull.facet_vertices(f)) fmt::format_to(out, " {}", v + 1);
    text += "\n";
  }
  return write_whole_file(arguments.output, text);
}

/// The checks over all facets and points are for the eye: a sample of the points where there are many.
std::vector<Vec3> sample(const std::vector<Vec3>& points, std::size_t most) {
  if (points.size() <= most) return points;
  std::vector<Vec3> r;
  for (std::size_t i = 0; i < most; ++i) r.push_back(points[i * points.size() / most]);
  return r;
}

int run_simplify(const SimplifyArguments& arguments) {
  check_outputs({arguments.input}, {{"--output", arguments.output}, {"--picture", arguments.picture}});
  Progress progress("reading " + arguments.input);
  const query::MeshPoints scan = read_mesh_argument(arguments.input, kMostPoints);
  progress.begin(fmt::format("looking for a hull of {} points", scan.points.size()));
  const query::Stopwatch watch;
  std::vector<dimension::Vector<3>> points(scan.points.begin(), scan.points.end());
  const auto body = dimension::Body<3>::from_points(std::move(points));
  if (!body) {
    query::refuse(to_string(body.error().code), arguments.input + ": " + body.error().message, "");
  }
  const dimension::Side side = arguments.side == "inner" ? dimension::Side::inner : dimension::Side::outer;
  const auto small = dimension::approximate_body<3>(*body, arguments.epsilon, dimension::Representation::points, side);
  if (!small) query::refuse(to_string(small.error().code), "--epsilon: " + small.error().message, "");
  const std::vector<Vec3> vertices(small->points.begin(), small->points.end());
  const auto hull = ConvexPolytope::from_points(vertices);
  if (!hull) query::refuse(to_string(hull.error().code), hull.error().message, hull.error().where);
  const double milliseconds = static_cast<double>(watch.nanoseconds()) / 1e6;
  if (!write_obj(*hull, arguments)) return cannot_write({"--output", arguments.output});
  constexpr std::size_t kChecked = 200'000;
  progress.begin(fmt::format("measuring {} facets", hull->num_facets()));
  const Excess excess = measure(*hull, sample(scan.points, kChecked));
  progress.end();
  fmt::print("scan      {}  ({} points{})\n", printable(arguments.input), scan.points.size(),
             scan.left_out > 0 ? fmt::format("; {} without a measurement (NaN) are left out", scan.left_out) : "");
  fmt::print("hull      {}  ({} vertices, {} facets, {:.1f} ms)\n", printable(arguments.output), hull->num_vertices(),
             hull->num_facets(), milliseconds);
  fmt::print("side      {}, epsilon {}\n", arguments.side, arguments.epsilon);
  fmt::print(
      "measured  along the hull's facets{}: points stick out by at most {:.3g}, facets stand off by at most {:.3g}\n",
      scan.points.size() > kChecked ? " (a sample of the points)" : "", excess.scan_outside, excess.largest_gap);
  if (arguments.picture.empty()) return kDone;
#ifdef PDEPTH_WITH_DEMOS
  return demo::write_simplify_picture(scan.points, *hull, arguments.side, arguments.epsilon, arguments.picture);
#else
  return refuse_picture(arguments.picture);
#endif
}

}  // namespace

void add_simplify_command(CLI::App& app, Action& action) {
  auto arguments = std::make_shared<SimplifyArguments>();
  CLI::App* command = app.add_subcommand("simplify", "A small convex hull of a dense scan, with a stated error");
  command->footer(kSimplifyFooter);
  command->add_option("SCAN", arguments->input, "Points or mesh: OBJ, STL, PLY, OFF, glTF, XYZ or PCD")->required();
  command->add_option("-o,--output", arguments->output, "The hull, as OBJ")
      ->required()
      ->check(refuse_other_meshes, "FILE.obj");
  command->add_option("--epsilon", arguments->epsilon, "Error, relative to the scan's extent")
      ->check(number_check(1e-6, std::nextafter(1.0, 0.0), "FLOAT in [1e-06, 1)"))
      ->capture_default_str();
  command->add_option("--side", arguments->side, "Encloses the scan, or is enclosed by it")
      ->check(one_of({"outer", "inner"}))
      ->capture_default_str();
  command->add_option("--picture", arguments->picture, "Draw scan and hull side by side as a PNG")
      ->check(refuse_other_pictures, "FILE.png");
  command->callback([arguments, &action] { action = [arguments] { return run_simplify(*arguments); }; });
}

}  // namespace pd::cli
