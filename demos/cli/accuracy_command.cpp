/// @file
/// `pdepth accuracy`: who fails what. Recorder programs over generated families of hard pairs, audited.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "audit/accuracy_engines.hpp"
#include "audit/accuracy_report.hpp"
#include "audit/mesh_cases.hpp"
#include "commands.hpp"
#include "line_input.hpp"
#include "options.hpp"
#include "pd/numeric/whole_file.hpp"
#include "progress.hpp"
#include "scenes/shape_families.hpp"
#include "support/complain.hpp"
#include "support/refusal.hpp"
#include "usage.hpp"

namespace pd::cli {

namespace {

constexpr const char* kAccuracyFooter =
    R"(A recorder answers --list with its engines, and --engine E --family F --pairs N --vertices V --seed S --out FILE
with a contact record in FILE. Built beside this command where the packages are: record_peers (ours, Bullet in single
precision, libccd, FCL, ODE, MuJoCo), record_peers_double (Bullet in double precision) and record_dart (DART's
detectors). Rows that end on -pdepth are pdepth's contacts through its door into that engine.

--cases and --meshes take the place of the families, unless --families names some; the pairs of a record are asked as
they stand there, whatever its engine reported.

Errors are the larger of depth error and normal excess, relative to the size of the pair. Our own row is judged by the
same library; pdepth-bench accuracy judges every row by an oracle that shares no code with it.

Examples:
  pdepth accuracy
  pdepth accuracy --families prism,needle --pairs 200 --csv table.csv
  pdepth accuracy --report page
  pdepth accuracy --cases contacts.jsonl --meshes robot/meshes)";

struct AccuracyArguments {
  std::vector<std::string> recorders;
  std::vector<std::string> only_families;
  std::vector<std::string> engines;
  std::string cases;   ///< a record
  std::string meshes;  ///< a folder
  std::string csv;
  std::string report;  ///< a folder
  bool force = false;
  audit::AccuracySettings settings;
};

std::vector<std::string> all_families() {
  std::vector<std::string> names;
  for (int f = 0; f < scenes::kPairFamilies; ++f) {
    names.emplace_back(to_string(static_cast<scenes::PairFamily>(f)));
  }
  return names;
}

/// The command that gives the same page again.
std::string command_of(const AccuracyArguments& arguments) {
  const audit::AccuracySettings& settings = arguments.settings;
  std::string text = fmt::format("pdepth accuracy --pairs {} --vertices {} --seed {} --tolerance {:g}", settings.pairs,
                                 settings.vertices, settings.seed, settings.tolerance);
  if (!arguments.only_families.empty()) text += fmt::format(" --families {}", fmt::join(arguments.only_families, ","));
  if (!arguments.engines.empty()) text += fmt::format(" --engines {}", fmt::join(arguments.engines, ","));
  if (!arguments.cases.empty()) text += fmt::format(" --cases '{}'", arguments.cases);
  if (!arguments.meshes.empty()) text += fmt::format(" --meshes '{}'", arguments.meshes);
  return text + fmt::format(" --report '{}'", arguments.report);
}

int run_accuracy_command(AccuracyArguments arguments) {
  arguments.settings.threads = number_of_threads(arguments.settings.threads);
  check_outputs({arguments.cases}, {{"--csv", arguments.csv}});
  if (const std::string words = report::foreign_page(arguments.report); !words.empty() && !arguments.force) {
    query::refuse("bad_value", "--report: " + words, "");
  }
  const bool own_pairs = !arguments.cases.empty() || !arguments.meshes.empty();
  const auto families = arguments.only_families.empty() && !own_pairs ? all_families() : arguments.only_families;
  std::vector<audit::AccuracySource> sources;
  for (const std::string& family : families) sources.push_back({family, {}});
  if (!arguments.cases.empty()) {
    sources.push_back({std::filesystem::path(arguments.cases).stem(), std::filesystem::absolute(arguments.cases)});
  }
  std::optional<audit::MeshCases> meshes;
  if (!arguments.meshes.empty()) {
    meshes.emplace(arguments.meshes, arguments.settings);
    for (const std::string& complaint : meshes->complaints()) complain("{}", complaint);
    if (!meshes->good()) return kBadUsage;
    sources.push_back({"meshes", meshes->path()});
  }
  std::vector<std::string> complaints;
  const auto engines = audit::find_engines(arguments.recorders, arguments.engines, complaints);
  for (const std::string& complaint : complaints) complain("{}", complaint);
  if (engines.empty() && complaints.empty()) {
    complain(
        "no engine to ask: install Debian's package pdepth-recorders, build record_peers (PD_WITH_RECORDERS), or name "
        "a --recorder");
  }
  if (engines.empty()) return kBadUsage;
  int started = 0;
  std::atomic<double> asked = 0;
  const double all = static_cast<double>(engines.size() * sources.size());
  Progress progress("accuracy", [&] { return asked / all; });
  arguments.settings.begins = [&](const std::string& engine, const std::string& family) {
    progress.begin(fmt::format("{}: {}", engine, family));
    asked = started++;
  };
  const audit::AccuracyTable table =
      audit::run_engines(engines, sources, arguments.settings, !arguments.report.empty());
  progress.end();
  fmt::print("{}", printable(audit::accuracy_text(table), "\n"));
  if (!arguments.csv.empty() && !write_whole_file(arguments.csv, audit::accuracy_csv(table))) {
    return cannot_write({"--csv", arguments.csv});
  }
  const char* judge =
      "Recorder programs asked each engine, and the audit judged what they wrote; judge and pdepth's own row share a "
      "library (pdepth-bench accuracy judges by one that shares no code).";
  if (!arguments.report.empty() &&
      !report::write_page(arguments.report,
                          audit::accuracy_page(table, arguments.settings, judge, command_of(arguments)))) {
    return cannot_write_page(arguments.report);
  }
  if (!arguments.report.empty()) fmt::print("\npage: {}/report.html\n", printable(arguments.report));
  return table.any_failed() ? kBadUsage : kDone;
}

}  // namespace

void add_accuracy_command(CLI::App& app, Action& action) {
  auto arguments = std::make_shared<AccuracyArguments>();
  arguments->settings.threads = 0;
  audit::AccuracySettings& settings = arguments->settings;
  CLI::App* command = app.add_subcommand("accuracy", "Who fails what: engines over generated families of hard pairs");
  command->footer(kAccuracyFooter);
  command
      ->add_option("--recorder", arguments->recorders,
                   "Programs that record (default: those beside this one, or installed with it)")
      ->delimiter(',');
  command->add_option("--engines", arguments->engines, "Only these; a name that no recorder knows lists them")
      ->delimiter(',');
  command->add_option("--families", arguments->only_families, "Only these")
      ->delimiter(',')
      ->check(one_of(all_families()));
  command->add_option("--pairs", settings.pairs, "Pairs of a family at each of its four depths")
      ->check(number_between(1, 100'000))
      ->capture_default_str();
  command->add_option("--vertices", settings.vertices, "Vertices of a body, where its family leaves the choice")
      ->check(number_between(4, 100'000))
      ->capture_default_str();
  command->add_option("--seed", settings.seed, "Seed of the generated pairs")
      ->check(number_between(std::int64_t{0}, std::int64_t{1} << 53))
      ->capture_default_str();
  command->add_option("--tolerance", settings.tolerance, "Of missed and phantom, relative to a pair's size")
      ->check(number_between(1e-15, 1.0))
      ->capture_default_str();
  command->add_option("--csv", arguments->csv, "Write engine by family to this file");
  command->add_option("--cases", arguments->cases, "The pairs of convex bodies of this contact record")
      ->check(CLI::ExistingFile);
  command->add_option("--meshes", arguments->meshes, "Pairs of hulls of the meshes of this folder")
      ->check(CLI::ExistingDirectory);
  command->add_option("--report", arguments->report, "Write report.html, a page for people, into this folder");
  command->add_flag("--force", arguments->force, "Replace a report.html that pdepth did not write");
  add_threads_option(*command, settings.threads, "judge");
  command->callback([arguments, &action] { action = [arguments] { return run_accuracy_command(*arguments); }; });
}

}  // namespace pd::cli
