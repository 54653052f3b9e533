/// @file
/// `pdepth demo NAME`: hands the demos their options.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <cctype>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>

#include "commands.hpp"
#include "options.hpp"
#include "support/complain.hpp"
#include "support/demo_options.hpp"
#include "support/refusal.hpp"
#include "usage.hpp"
#ifdef PDEPTH_WITH_DEMOS
#include "report/page.hpp"
#include "support/demo_registry.hpp"
#endif

namespace pd::cli {

namespace {

struct DemoArguments {
  std::string name;
  std::string size;
  std::string out;
  std::string report;  ///< a folder
  demo::DemoOptions options;
};

#ifdef PDEPTH_WITH_DEMOS

std::string demo_list() {
  std::string text = "Demos:\n";
  for (const demo::Demo& demo : demo::demos()) text += fmt::format("  {:<12} {}\n", demo.name, demo.description);
  return text;
}

/// "1280x720"
bool parse_size(const std::string& text, int& width, int& height) {
  constexpr int kSmallest = 64;
  constexpr int kLargest = 7680;
  const std::size_t cross = text.find('x');
  if (cross == std::string::npos) return false;
  return CLI::detail::lexical_cast(text.substr(0, cross), width) &&
         CLI::detail::lexical_cast(text.substr(cross + 1), height) && width >= kSmallest && width <= kLargest &&
         height >= kSmallest && height <= kLargest;
}

/// The command that makes the same page again.
std::string command_of(const DemoArguments& arguments) {
  const demo::DemoOptions& options = arguments.options;
  std::string text = "pdepth demo " + arguments.name;
  for (const std::string& file : options.inputs) text += fmt::format(" '{}'", file);
  if (!options.scene.empty()) text += " --scene " + options.scene;
  if (options.steps > 0) text += fmt::format(" --steps {}", options.steps);
  if (!arguments.size.empty()) text += " --size " + arguments.size;
  if (!options.solver.empty()) text += " --solver " + options.solver;
  if (!options.trace.empty()) text += fmt::format(" --trace '{}'", options.trace);
  if (options.video) text += " --video";
  return text + fmt::format(" --seed {} --report '{}'", options.seed, arguments.report);
}

/// Runs demos into folders of their names and writes the page of them all.
int run_with_report(const DemoArguments& arguments, std::span<const demo::Demo> chosen) {
  if (const std::string words = report::foreign_page(arguments.report); !words.empty() && !arguments.options.force) {
    query::refuse("bad_value", "--report: " + words, "");
  }
  report::Page page;
  const bool one = chosen.size() == 1;
  page.title = one ? std::string(chosen.front().description) : "Penetration depth, exact and certified: all demos";
  page.title[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(page.title[0])));
  page.text =
      "How deep two convex bodies stick in each other, which shortest move takes them apart, and what an "
      "engine's wrong answers do to its world.";
  page.commands = {command_of(arguments)};
  page.seed = fmt::format("{}", arguments.options.seed);
  for (const demo::Demo& demo : chosen) {
    demo::DemoOptions options = arguments.options;
    options.out = std::filesystem::path(arguments.report) / std::string(demo.name);
    options.page = &page;
    options.page_folder = std::string(demo.name);
    if (const int code = demo.run(options); code != kDone) return code;
  }
  if (!report::write_page(arguments.report, page)) return cannot_write_page(arguments.report);
  fmt::print("Page: {}/report.html\n", printable(arguments.report));
  return kDone;
}

int run_demo(DemoArguments arguments) {
  if (arguments.name.empty()) {
    fmt::print("{}", demo_list());
    return kDone;
  }
  const demo::Demo* demo = demo::find_demo(arguments.name);
  const bool all = arguments.name == "all";
  if (demo == nullptr && !all) {
    complain("there is no demo \"{}\"", arguments.name);
    fmt::print(stderr, "{}", demo_list());
    return kBadUsage;
  }
  demo::DemoOptions& options = arguments.options;
  if (!arguments.size.empty() && !parse_size(arguments.size, options.width, options.height)) {
    complain("--size must be WIDTHxHEIGHT, each from 64 to 7680, e.g. 1280x720");
    return kBadUsage;
  }
  if (!options.scene.empty() && (all || !demo->has_scenes)) {
    complain("--scene belongs to the demos stacking and rollback");
    return kBadUsage;
  }
  options.out = arguments.out;
  if (all && arguments.report.empty()) arguments.report = "pdepth_out/all";
  if (arguments.report.empty() || options.scene == "list") return demo->run(options);
  if (!arguments.out.empty()) {
    complain("--report makes the folder of the files itself: leave --out away");
    return kBadUsage;
  }
  return run_with_report(arguments, all ? demo::demos() : std::span(demo, 1));
}

#else

std::string demo_list() { return "This command has no demos: they are in the package pdepth-pictures.\n"; }

int run_demo(const DemoArguments& /*arguments*/) {
  complain(
      "this command has no demos; Debian's package pdepth-pictures, or a build with PD_WITH_RENDER and PD_WITH_BULLET, "
      "has");
  return kBadUsage;
}

#endif

}  // namespace

void add_demo_command(CLI::App& app, Action& action) {
  auto arguments = std::make_shared<DemoArguments>();
  demo::DemoOptions& options = arguments->options;
  CLI::App* command = app.add_subcommand("demo", "Run a demo: pictures, figures and, with --video, a film");
  command->footer(demo_list() + R"(
Examples:
  pdepth demo stacking --steps 240 --video --out stacking
  pdepth demo stacking --scene list
  pdepth demo all --report show
  pdepth demo difference a.obj b.obj --size 1920x1080
  pdepth demo difference --trace search.jsonl)");
  command->add_option("NAME", arguments->name, "Which demo, or `all`; without it they are listed");
  command->add_option("FILES", options.inputs, "Meshes, for the demos that take some");
  command->add_option("--scene", options.scene, "One scene of stacking or rollback; `list` names them");
  command->add_option("--steps", options.steps, "Steps of the simulation; 0 = the demo's own choice")
      ->check(number_between(0, 1'000'000))
      ->capture_default_str();
  command->add_option("--size", arguments->size, "Size of a frame, WIDTHxHEIGHT [1280x720]");
  command->add_option("--out", arguments->out, "Folder for the files [pdepth_out/NAME]");
  command->add_option("--report", arguments->report,
                      "Make a page: DIR/report.html, with the demo's files in DIR/NAME beside it");
  command->add_option("--solver", options.solver, "The solver shown first")
      ->check(one_of({"exact", "approx", "bullet-epa", "bullet-minkowski"}));
  command->add_option("--seed", options.seed, "Seed of what is random")
      ->check(number_between(std::int64_t{0}, std::int64_t{1} << 53))
      ->capture_default_str();
  command->add_option("--trace", options.trace, "A search that `pdepth depth --trace` wrote, drawn (difference)");
  command->add_flag("--video", options.video, "Also write an H.264 film (needs ffmpeg)");
  command->add_flag("--force", options.force, "Replace files that are already there");
  command->callback([arguments, &action] { action = [arguments] { return run_demo(*arguments); }; });
}

}  // namespace pd::cli
