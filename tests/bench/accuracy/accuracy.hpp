/// @file
/// `pdepth-bench accuracy`: `pdepth accuracy` with the tests' oracle as the judge, which shares no code with the core.
#pragma once

#include <string>
#include <vector>

#include "audit/accuracy_run.hpp"

namespace pd::bench {

struct AccuracyOptions {
  std::vector<std::string> families;  ///< empty: all
  std::vector<std::string> engines;   ///< empty: all
  std::string cases;                  ///< a record whose pairs are asked, too; empty: none
  std::string csv;
  std::string report;  ///< a folder
  audit::AccuracySettings settings;
};

/// A recorded contact of two hulls of points, judged in exact arithmetic by brute force. Other shapes, and distances
/// that the oracle cannot certify, are not answered.
[[nodiscard]] audit::Judgement judge_by_oracle(const audit::RecordedContact& contact, double tolerance);

/// Prints the tables and writes the files that were asked for.
/// @return 0; 1 where pdepth's own row holds a contact that is wrong or a file cannot be written; 2 for a bad name
int run_accuracy_by_oracle(const AccuracyOptions& options);

}  // namespace pd::bench
