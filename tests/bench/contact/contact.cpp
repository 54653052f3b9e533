#include "bench/contact/contact.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "bench/contact/contact_report.hpp"
#include "bench/contact/contact_run.hpp"
#include "bench/measure/stopwatch.hpp"

namespace pd::bench {

namespace {

using scenes::ContactRun;

/// The runs of the names; empty and a word on stderr where a name is unknown.
std::vector<ContactRun> runs_of(const std::vector<std::string>& names) {
  if (names.empty()) {
    return {std::begin(scenes::kContactRuns), std::end(scenes::kContactRuns)};
  }
  std::vector<ContactRun> result;
  for (const std::string& name : names) {
    const auto* found = std::find_if(std::begin(scenes::kContactRuns), std::end(scenes::kContactRuns),
                                     [&](ContactRun run) { return scenes::to_string(run) == name; });
    if (found == std::end(scenes::kContactRuns)) {
      fmt::print(stderr, "--runs: no way to find contacts of this name: {}\n", name);
      return {};
    }
    result.push_back(*found);
  }
  return result;
}

std::vector<std::string> scene_names(const ContactOptions& options) {
  std::vector<std::string> result;
  const auto& all = scenes::contact_scenes();
  for (const std::string& name : options.scenes) {
    if (std::none_of(all.begin(), all.end(), [&](const auto& m) { return m.name == name; })) {
      fmt::print(stderr, "--scene: no scene of this name: {}\n", name);
      return {};
    }
  }
  for (const auto& maker : all) {
    const bool named = std::find(options.scenes.begin(), options.scenes.end(), maker.name) != options.scenes.end();
    if (named || (options.scenes.empty() && (!options.quick || maker.make(0).quick))) {
      result.push_back(maker.name);
    }
  }
  return result;
}

/// The median over starts, field by field; of the steps' times, step by step.
ContactFigures median_of(const std::vector<ContactStart>& starts) {
  ContactFigures result;
  for (const FigureColumn& column : figure_columns()) {
    std::vector<double> values;
    for (const ContactStart& start : starts) {
      values.push_back(start.figures.*column.field);
    }
    result.*column.field = quantile(values, 0.5);
  }
  quantiles_of_steps(starts, result);
  return result;
}

/// Of our runs, over all scenes and starts.
struct QueryTotals {
  double queries = 0, exact_signs = 0, wider = 0;

  void add(const ContactFigures& figures) {
    queries += figures.queries;
    exact_signs += figures.exact_signs;
    wider += figures.wider;
  }
  /// Says so, and whether all queries kept away from numbers of unbounded length.
  [[nodiscard]] bool print() const {
    fmt::print("{:.0f} queries, {:.0f} decided by exact numbers{}, {:.0f} with a wider bracket ({:.2g} of all)\n",
               queries, exact_signs, exact_signs > 0 ? " (0 PROMISED)" : "", wider, queries > 0 ? wider / queries : 0);
    return exact_signs == 0;
  }
};

}  // namespace

int run_contact(const ContactOptions& options) {
  const std::vector<ContactRun> runs = runs_of(options.runs);
  const std::vector<std::string> names = scene_names(options);
  if (runs.empty() || names.empty()) {
    return 2;
  }
  const int starts = options.starts > 0 ? options.starts : options.quick ? 1 : 10;
  std::vector<ContactRow> rows;
  QueryTotals totals;
  for (const std::string& name : names) {
    const scenes::ContactScene plan = scenes::contact_scene(name);
    const double seconds = options.seconds > 0 ? options.seconds : options.quick ? plan.quick_seconds : plan.seconds;
    std::vector<double> rates = options.rates;
    if (rates.empty()) {
      rates = plan.rates;
      if (options.quick) {
        rates.resize(1);
      }
    }
    for (const double rate : rates) {
      for (const std::string& setting : options.settings) {
        std::vector<ContactSetting> settings;
        for (const ContactRun run : runs) {
          settings.push_back({run, rate, setting != "default", setting == "stack", options.iterations});
        }
        std::vector<std::vector<ContactStart>> by_run(runs.size());
        for (int start = 0; start < starts; ++start) {
          const scenes::ContactScene scene = scenes::contact_scene(name, static_cast<std::uint64_t>(start));
          std::vector<ContactStart> shown = run_contact_scene(scene, settings, seconds);
          for (std::size_t i = 0; i < runs.size(); ++i) {
            totals.add(shown[i].figures);
            by_run[i].push_back(std::move(shown[i]));
          }
        }
        std::vector<ContactRow> block;
        for (std::size_t i = 0; i < runs.size(); ++i) {
          block.push_back({plan.name, plan.goal, rate, setting, std::string(scenes::to_string(runs[i])), starts,
                           seconds, plan.wanted_speed, median_of(by_run[i])});
        }
        print_block(plan, block);
        rows.insert(rows.end(), block.begin(), block.end());
      }
    }
  }
  print_verdicts(rows);
  const bool in_doubles = totals.print();
  bool good = options.csv.empty() || write_text(options.csv, to_csv(rows));
  good = write_report(options.report, report_of_contact(rows)) && good;
  if (!options.plots.empty()) {
#ifdef PD_BENCH_WITH_RENDER
    good = plot_contact(rows, options.plots) && good;
#else
    fmt::print(stderr, "--plots: this was built without render\n");
    good = false;
#endif
  }
  return good && in_doubles ? 0 : 1;
}

}  // namespace pd::bench
