/// @file
/// The table of `pdepth-bench contact`: columns, verdicts by stated thresholds, CSV and plots.
#pragma once

#include <string>
#include <vector>

#include "bench/contact/contact_run.hpp"
#include "bench/report/bench_report.hpp"

namespace pd::bench {

struct FigureColumn {
  const char* name;
  double ContactFigures::*field;
};
[[nodiscard]] const std::vector<FigureColumn>& figure_columns();

struct ContactRow {
  std::string scene;
  scenes::ContactGoal goal;
  double steps_per_second;
  std::string setting;
  std::string run;
  int starts;
  double seconds;
  double wanted_speed;
  ContactFigures figures;
};

/// The rows of one scene, step length and setting.
void print_block(const scenes::ContactScene& scene, const std::vector<ContactRow>& block);

/// One judged comparison of ours with the best of the others in the same block.
struct ContactVerdict {
  std::string scene;
  double steps_per_second;
  std::string setting;
  std::string figure;
  double ours;
  double best;       ///< of the others
  double threshold;  ///< what ours may be
  bool good;
};

/// Thresholds: a step's median no longer than Bullet's fastest run, p99 and longest within 1.5 of it; fall time, drift
/// and tail speed at least those of the best other run, where equal means within 10 % or 1e-4 of a body; nobody lost;
/// no deeper than Bullet's best; the wanted speed within 1 %; the height after a first bounce within 5 % of e^2; no
/// more bodies toppled and no more energy gained than the best.
[[nodiscard]] std::vector<ContactVerdict> judge_contact(const std::vector<ContactRow>& rows);

void print_verdicts(const std::vector<ContactRow>& rows);
/// Columns scene,steps_per_second,settings,run,starts,seconds and the figures.
[[nodiscard]] std::string to_csv(const std::vector<ContactRow>& rows);
/// Runs beside each other, verdicts, all figures.
[[nodiscard]] BenchReport report_of_contact(const std::vector<ContactRow>& rows);
/// Bar-like charts of ms a step and of drift over the scenes, as PNG files in `folder`.
bool plot_contact(const std::vector<ContactRow>& rows, const std::string& folder);

}  // namespace pd::bench
