/// @file
/// `pdepth-bench contact`: worlds under Bullet's ways to find contacts and ours.
#pragma once

#include <string>
#include <vector>

#include "bench/report/report_target.hpp"

namespace pd::bench {

struct ContactOptions {
  std::vector<std::string> scenes;  ///< names; none: all (quick: the quick ones)
  std::vector<std::string> runs;    ///< names; none: all
  std::vector<double> rates;        ///< steps a second; none: each scene's own (quick: its first)
  /// Of the constraint solver: Bullet's, `pd::apply_recommended`, and "stack": `pd::StackSolver` with those but for ten
  /// sweeps.
  std::vector<std::string> settings{"default", "recommended"};
  int iterations = 0;  ///< of the constraint solver; 0: as the settings say
  int starts = 0;      ///< perturbed starts a scene; 0: 10, quick 1
  double seconds = 0;  ///< of each run; 0: the scene's own
  bool quick = false;
  std::string csv;
  std::string plots;
  ReportTarget report = {};
};

/// Prints a table and its verdicts, writes the files that were asked for. @return the program's exit code.
int run_contact(const ContactOptions& options);

}  // namespace pd::bench
