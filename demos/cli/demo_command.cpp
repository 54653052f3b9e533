/// @file
/// `pdepth demo NAME`: hands the demos their options.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <string>

#include "commands.hpp"
#include "support/demo_options.hpp"
#ifdef PDEPTH_WITH_DEMOS
#include "support/demo_registry.hpp"
#endif

namespace pd::cli {

namespace {

struct DemoArguments {
  std::string name;
  std::string size;
  std::string out;
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

int run_demo(DemoArguments arguments) {
  if (arguments.name.empty()) {
    fmt::print("{}", demo_list());
    return kDone;
  }
  const demo::Demo* demo = demo::find_demo(arguments.name);
  if (demo == nullptr) {
    fmt::print(stderr, "pdepth: there is no demo \"{}\"\n{}", arguments.name, demo_list());
    return kBadUsage;
  }
  demo::DemoOptions& options = arguments.options;
  if (!arguments.size.empty() && !parse_size(arguments.size, options.width, options.height)) {
    fmt::print(stderr, "pdepth: --size must be WIDTHxHEIGHT, each from 64 to 7680, e.g. 1280x720\n");
    return kBadUsage;
  }
  options.out = arguments.out;
  return demo->run(options);
}

#else

std::string demo_list() { return "This build has no demos: they need Bullet and render.\n"; }

int run_demo(const DemoArguments& /*arguments*/) {
  fmt::print(stderr, "pdepth: this build has no demos: they need PD_WITH_BULLET and PD_WITH_RENDER\n");
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
  pdepth demo difference a.obj b.obj --size 1920x1080
  pdepth demo difference --trace search.jsonl)");
  command->add_option("NAME", arguments->name, "Which demo; without it they are listed");
  command->add_option("FILES", options.inputs, "Meshes, for the demos that take some");
  command->add_option("--steps", options.steps, "Steps of the simulation; 0 = the demo's own choice")
      ->check(CLI::Range(0, 1'000'000))
      ->capture_default_str();
  command->add_option("--size", arguments->size, "Size of a frame, WIDTHxHEIGHT [1280x720]");
  command->add_option("--out", arguments->out, "Folder for the files [pdepth_out/NAME]");
  command->add_option("--solver", options.solver, "The solver shown first")
      ->check(CLI::IsMember({"exact", "approx", "bullet-epa", "bullet-minkowski"}));
  command->add_option("--seed", options.seed, "Seed of what is random")->capture_default_str();
  command->add_option("--trace", options.trace, "A search that `pdepth depth --trace` wrote, drawn (difference)");
  command->add_flag("--video", options.video, "Also write an H.264 film (needs ffmpeg)");
  command->add_flag("--force", options.force, "Replace files that are already there");
  command->callback([arguments, &action] { action = [arguments] { return run_demo(*arguments); }; });
}

}  // namespace pd::cli
