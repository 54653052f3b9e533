#include "bench/measure/compare.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <sstream>
#include <tuple>

#include "bench/measure/stopwatch.hpp"
#include "bench/peers/solver.hpp"

extern char** environ;

namespace pd::bench {

namespace {

using Key = std::tuple<std::string, int, std::string, std::string>;

Key key_of(const Row& r) { return {r.family, r.vertices, r.depth, r.solver}; }

/// Runs a program with its output thrown away; true when it ended with 0 (or with 1: wrong answers are no hindrance
/// here).
bool run_quietly(const std::filesystem::path& program, std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), program.string());
  std::vector<char*> pointers;
  for (std::string& a : arguments) pointers.push_back(a.data());
  pointers.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t child = 0;
  const int failed = posix_spawn(&child, program.c_str(), &actions, nullptr, pointers.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (failed != 0) return false;
  int status = 0;
  if (waitpid(child, &status, 0) != child) return false;
  return WIFEXITED(status) && WEXITSTATUS(status) <= 1;
}

/// One run's table, or nothing (the reason is printed).
std::vector<Row> table_of(const std::filesystem::path& program, const CompareSettings& settings,
                          const std::filesystem::path& csv) {
  std::vector<std::string> arguments{"pairs"};
  arguments.insert(arguments.end(), settings.arguments.begin(), settings.arguments.end());
  arguments.insert(arguments.end(), {"--csv", csv.string()});
  if (!run_quietly(program, arguments)) {
    fmt::print(stderr, "{}: did not run to its end\n", program.string());
    return {};
  }
  std::ifstream in(csv);
  std::stringstream text;
  text << in.rdbuf();
  auto rows = from_csv(text.str());
  if (!rows) {
    fmt::print(stderr, "{}: {}\n", program.string(), rows.error().message);
    return {};
  }
  return *std::move(rows);
}

}  // namespace

std::vector<Comparison> compare_tables(const std::vector<std::vector<Row>>& before,
                                       const std::vector<std::vector<Row>>& after) {
  struct Samples {
    std::vector<double> before;
    std::vector<double> after;
    std::vector<double> ratios;
  };
  std::map<Key, Samples> samples;
  std::vector<Key> order;
  for (std::size_t round = 0; round < before.size(); ++round) {
    std::map<Key, Row> twins;
    for (const Row& r : after[round]) twins.emplace(key_of(r), r);
    for (const Row& b : before[round]) {
      const auto twin = twins.find(key_of(b));
      if (twin == twins.end()) continue;
      const Row& a = twin->second;
      auto [place, fresh] = samples.try_emplace(key_of(b));
      if (fresh) order.push_back(key_of(b));
      place->second.before.push_back(b.p50_ns);
      place->second.after.push_back(a.p50_ns);
      const bool beside_bullet = std::isfinite(b.ratio_to_bullet) && std::isfinite(a.ratio_to_bullet);
      place->second.ratios.push_back(beside_bullet ? a.ratio_to_bullet / b.ratio_to_bullet : a.p50_ns / b.p50_ns);
    }
  }
  std::vector<Comparison> result;
  for (const Key& key : order) {
    const Samples& s = samples[key];
    const auto [family, vertices, depth, solver] = key;
    result.push_back({family, vertices, depth, solver, quantile(s.before, 0.5), quantile(s.after, 0.5),
                      quantile(s.ratios, 0.5), quantile(s.ratios, 0), quantile(s.ratios, 1)});
  }
  return result;
}

std::string_view verdict_of(const Comparison& comparison) {
  if (comparison.largest < 0.98) return "faster";
  return comparison.least > 1.02 ? "SLOWER" : "";
}

int run_compare(const CompareSettings& settings, std::vector<Comparison>& comparisons) {
  std::vector<std::vector<Row>> before;
  std::vector<std::vector<Row>> after;
  const std::filesystem::path csv =
      std::filesystem::temp_directory_path() / fmt::format("pdepth-bench-{}.csv", static_cast<long>(getpid()));
  for (int round = 0; round < settings.rounds; ++round) {
    // The order alternates, so that a drift of the machine favours neither.
    for (int turn = 0; turn < 2; ++turn) {
      const bool older = (round + turn) % 2 == 0;
      std::vector<Row> rows = table_of(older ? settings.before : settings.after, settings, csv);
      std::error_code ignored;  // nothing depends on the file being gone
      std::filesystem::remove(csv, ignored);
      if (rows.empty()) return 1;
      (older ? before : after).push_back(std::move(rows));
    }
    fmt::print(stderr, "round {} of {}\n", round + 1, settings.rounds);
  }
  fmt::print("{:<7} {:>8} {:<8} {:<17} {:>10} {:>10} {:>8} {:>15}\n", "family", "vertices", "depth", "solver",
             "before ns", "after ns", "ratio", "least..largest");
  std::vector<double> ratios;
  comparisons = compare_tables(before, after);
  for (const Comparison& c : comparisons) {
    if (c.solver == kBulletEpa) continue;
    fmt::print("{:<7} {:>8} {:<8} {:<17} {:>10.0f} {:>10.0f} {:>8.3f} {:>7.3f}..{:<6.3f} {}\n", c.family, c.vertices,
               c.depth, c.solver, c.before_ns, c.after_ns, c.ratio, c.least, c.largest, verdict_of(c));
    ratios.push_back(c.ratio);
  }
  fmt::print("geometric mean of {} cells: {:.3f}\n", ratios.size(), geometric_mean(ratios));
  return 0;
}

}  // namespace pd::bench
