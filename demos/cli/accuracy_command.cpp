/// @file
/// `pdepth accuracy`: who fails what. Recorder programs over generated families of hard pairs, audited.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "audit/accuracy_run.hpp"
#include "commands.hpp"
#include "line_input.hpp"
#include "scenes/shape_families.hpp"

namespace pd::cli {

namespace {

constexpr const char* kFooter =
    R"(A recorder answers --list with its engines, and --engine E --family F --pairs N --vertices V --seed S --out FILE
with a contact record in FILE. Built beside this command where the packages are: record_peers (ours, Bullet in single
precision, libccd, FCL, ODE) and record_peers_double (Bullet in double precision).

Errors are the larger of depth error and normal excess, relative to the size of the pair. Our own row is judged by the
same library; the program oracle_pairs judges our depths by an oracle that shares no code with it.

Examples:
  pdepth accuracy
  pdepth accuracy --families prism,needle --pairs 200 --csv table.csv)";

struct AccuracyArguments {
  std::vector<std::string> recorders;
  std::vector<std::string> families;
  std::vector<std::string> engines;
  std::string csv;
  audit::AccuracySettings settings;
};

std::vector<std::string> all_families() {
  std::vector<std::string> names;
  for (int f = 0; f < scenes::kPairFamilies; ++f) {
    names.emplace_back(to_string(static_cast<scenes::PairFamily>(f)));
  }
  return names;
}

/// The recorders that the build put beside this program.
std::vector<std::string> recorders_beside() {
  std::error_code error;
  const std::filesystem::path here = std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
  std::vector<std::string> found;
  for (const char* name : {"record_peers", "record_peers_double"}) {
    if (std::filesystem::exists(here / name, error)) found.push_back(here / name);
  }
  return found;
}

struct Engine {
  std::string program;
  std::string name;
};

std::vector<Engine> engines_of(const AccuracyArguments& arguments) {
  std::vector<Engine> engines;
  for (const std::string& program : arguments.recorders) {
    const std::vector<std::string> names = audit::engines_of(program);
    if (names.empty()) fmt::print(stderr, "pdepth: {} names no engines (--list)\n", program);
    for (const std::string& name : names) {
      const bool wanted = arguments.engines.empty() || std::find(arguments.engines.begin(), arguments.engines.end(),
                                                                 name) != arguments.engines.end();
      const bool known =
          std::any_of(engines.begin(), engines.end(), [&](const Engine& engine) { return engine.name == name; });
      if (wanted && !known) engines.push_back({program, name});
    }
  }
  return engines;
}

std::string engine_table(const std::vector<audit::AccuracyRow>& totals) {
  std::string text = fmt::format("{:<24} {:>8} {:>7} {:>8} {:>7} {:>7} {:>9} {:>9} {:>9}\n", "engine", "contacts",
                                 "missed", "phantom", "> 1e-6", "> 1e-3", "no answer", "worst", "us");
  for (const audit::AccuracyRow& row : totals) {
    text += fmt::format("{:<24} {:>8} {:>7} {:>8} {:>7} {:>7} {:>9} {:>9.2g} {:>9.1f}{}\n", row.engine, row.contacts,
                        row.missed, row.phantom, row.above_small, row.above_large, row.no_answer, row.worst,
                        row.nanoseconds / 1e3, row.failed ? "  a run failed" : "");
  }
  return text;
}

/// Families down, engines across: contacts that a user would call wrong.
std::string family_table(const std::vector<Engine>& engines, const std::vector<std::string>& families,
                         const std::vector<audit::AccuracyRow>& rows) {
  std::string text = "\nmissed, phantom, wrong by more than 1e-3 or without an answer, of the contacts of a family\n";
  for (std::size_t e = 0; e < engines.size(); ++e) text += fmt::format("  {} = {}\n", e + 1, engines[e].name);
  text += fmt::format("\n{:<20}", "family");
  for (std::size_t e = 0; e < engines.size(); ++e) text += fmt::format(" {:>7}", e + 1);
  text += "\n";
  for (std::size_t f = 0; f < families.size(); ++f) {
    text += fmt::format("{:<20}", families[f]);
    for (std::size_t e = 0; e < engines.size(); ++e) {
      const audit::AccuracyRow& row = rows[e * families.size() + f];
      const std::string cell = row.failed          ? "failed"
                               : row.contacts == 0 ? "-"
                               : row.wrong() == 0  ? "."
                                                   : fmt::format("{}", row.wrong());
      text += fmt::format(" {:>7}", cell);
    }
    text += "\n";
  }
  return text;
}

bool write_csv(const std::string& path, const std::vector<audit::AccuracyRow>& rows) {
  std::FILE* file = std::fopen(path.c_str(), "w");
  if (file == nullptr) return false;
  fmt::print(file, "engine,family,failed,contacts,missed,phantom,above_1e-6,above_1e-3,no_answer,worst,nanoseconds\n");
  for (const audit::AccuracyRow& row : rows) {
    fmt::print(file, "{},{},{:d},{},{},{},{},{},{},{},{}\n", row.engine, row.family, row.failed, row.contacts,
               row.missed, row.phantom, row.above_small, row.above_large, row.no_answer, row.worst, row.nanoseconds);
  }
  const bool written = std::ferror(file) == 0;
  return std::fclose(file) == 0 && written;
}

int run_accuracy_command(AccuracyArguments arguments) {
  arguments.settings.threads = number_of_threads(arguments.settings.threads);
  if (arguments.families.empty()) arguments.families = all_families();
  if (arguments.recorders.empty()) arguments.recorders = recorders_beside();
  const std::vector<Engine> engines = engines_of(arguments);
  if (engines.empty()) {
    fmt::print(stderr, "pdepth: no engine to ask; build record_peers (PD_WITH_BENCH) or name a --recorder\n");
    return kBadUsage;
  }
  std::vector<audit::AccuracyRow> rows;
  std::vector<audit::AccuracyRow> totals;
  bool failed = false;
  for (const Engine& engine : engines) {
    totals.emplace_back();
    totals.back().engine = engine.name;
    for (const std::string& family : arguments.families) {
      rows.push_back(audit::run_accuracy(engine.program, engine.name, family, arguments.settings));
      totals.back().add(rows.back());
      failed = failed || rows.back().failed;
    }
  }
  fmt::print("{}{}", engine_table(totals), family_table(engines, arguments.families, rows));
  if (!arguments.csv.empty() && !write_csv(arguments.csv, rows)) {
    fmt::print(stderr, "pdepth: {} cannot be written\n", arguments.csv);
    return kFailed;
  }
  return failed ? kBadUsage : kDone;
}

}  // namespace

void add_accuracy_command(CLI::App& app, Action& action) {
  auto arguments = std::make_shared<AccuracyArguments>();
  arguments->settings.threads = 0;
  audit::AccuracySettings& settings = arguments->settings;
  CLI::App* command = app.add_subcommand("accuracy", "Who fails what: engines over generated families of hard pairs");
  command->footer(kFooter);
  command->add_option("--recorder", arguments->recorders, "Programs that record (default: those built beside this one)")
      ->delimiter(',');
  command->add_option("--engines", arguments->engines, "Only these")->delimiter(',');
  command->add_option("--families", arguments->families, "Only these")
      ->delimiter(',')
      ->check(CLI::IsMember(all_families()));
  command->add_option("--pairs", settings.pairs, "Pairs of a family at each of its four depths")
      ->check(CLI::Range(1, 100'000))
      ->capture_default_str();
  command->add_option("--vertices", settings.vertices, "Vertices of a body, where its family leaves the choice")
      ->check(CLI::Range(4, 100'000))
      ->capture_default_str();
  command->add_option("--seed", settings.seed)->capture_default_str();
  command->add_option("--tolerance", settings.tolerance, "Of missed and phantom, relative to a pair's size")
      ->check(CLI::Range(1e-15, 1.0))
      ->capture_default_str();
  command->add_option("--csv", arguments->csv, "Write engine by family to this file");
  add_threads_option(*command, settings.threads, "judge");
  command->callback([arguments, &action] { action = [arguments] { return run_accuracy_command(*arguments); }; });
}

}  // namespace pd::cli
