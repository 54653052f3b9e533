/// @file
/// The command `pdepth`: arguments in, subcommand out.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdlib>
#include <exception>

#include "commands.hpp"

namespace {

constexpr const char* kFooter = R"(Examples:
  pdepth depth part.obj fixture.stl --pose-a 0,0,0.25
  pdepth depth a.ply b.off --json
  pdepth check part.stl --fail-on solid
  pdepth polygon plate.svg tool.json --direction 0,1
  pdepth query lines.jsonl --threads 4 > answers.jsonl
  echo '{"id":1,"query":"depth","a":{"type":"box","half_extents":[1,1,1]},
         "b":{"type":"sphere","radius":1},"pose_b":{"translation":[1.5,0,0]}}' | tr -d '\n' | pdepth query
  pdepth audit contacts.jsonl --fail-on missed=0,phantom=0,depth_error=1e-4
  pdepth simplify scan.ply --epsilon 1e-3 -o hull.obj
  pdepth demo stacking --out frames

Exit codes:
  0    done; for `query`: every line has its answer (an error object is one)
  1    the work could not be finished (output that cannot be written, no graphics)
  2    bad usage, or input that cannot be read; for `audit`: not all could be judged
  3    for `audit`: a condition of --fail-on does not hold; for `check`: a fault of --fail-on is there
  130  stopped by Ctrl-C

`pdepth SUBCOMMAND --help` says more.)";

}  // namespace

int main(int argc, char** argv) {
  // Whole lines and whole frames are written at once, so that what stands there by then is complete.
  std::signal(SIGINT, [](int) { std::_Exit(pd::cli::kInterrupted); });
  CLI::App app("Penetration depth of convex bodies, exact and certified.", "pdepth");
  app.set_version_flag("--version", "pdepth " PDEPTH_VERSION);
  app.footer(kFooter);
  app.require_subcommand(1);
  pd::cli::Action action;
  pd::cli::add_depth_command(app, action);
  pd::cli::add_check_command(app, action);
  pd::cli::add_polygon_command(app, action);
  pd::cli::add_query_command(app, action);
  pd::cli::add_minimise_command(app, action);
  pd::cli::add_simplify_command(app, action);
  pd::cli::add_audit_command(app, action);
  pd::cli::add_accuracy_command(app, action);
  pd::cli::add_demo_command(app, action);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? pd::cli::kDone : pd::cli::kBadUsage;
  }
  try {
    return action();
  } catch (const std::exception& error) {
    fmt::print(stderr, "pdepth: {}\n", error.what());
    return pd::cli::kFailed;
  }
}
