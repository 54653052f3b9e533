/// @file
/// `--report DIR` of `pdepth-bench`: one page out of what a subcommand measured, with its tables as files beside it.
///
/// Every subcommand gives what it has as tables of comma-separated values, bars and lines; what a page is made of
/// stands in demos/report.
#pragma once

#include <string>
#include <vector>

#include "bench/hash/answer_hash.hpp"
#include "bench/measure/claims.hpp"
#include "bench/measure/compare.hpp"
#include "bench/measure/table.hpp"
#include "bench/pairs/coherent.hpp"
#include "bench/report/report_target.hpp"
#include "report/csv_table.hpp"
#include "report/page.hpp"

namespace pd::bench {

struct BenchReport {
  std::string title;
  std::string text;
  std::vector<report::Card> cards;
  std::vector<std::string> charts;  ///< XHTML, before the tables
  std::vector<report::CsvTable> tables;
  std::vector<report::CsvTable> files;  ///< beside the page only
};

/// Writes the page and its files, or says why not. True where none was asked for.
[[nodiscard]] bool write_report(const ReportTarget& target, const BenchReport& content);

/// Cold pairs: solvers over families, sizes and depths. @param what  "Cold single pairs"
[[nodiscard]] BenchReport report_of_pairs(const std::vector<Row>& rows, const std::string& what);
[[nodiscard]] BenchReport report_of_coherent(const std::vector<CoherentRow>& rows);
/// @param words  what the two programs were
[[nodiscard]] BenchReport report_of_comparison(const std::vector<Comparison>& comparisons, const std::string& words);
[[nodiscard]] BenchReport report_of_hash(const HashOutcome& outcome);
/// @param what  "The bounds of [A], measured"
[[nodiscard]] BenchReport report_of_claims(const ClaimTable& table, const std::string& what);

/// The program's own words as one line for a shell, with --seed where it had none (`seed` empty: none is added).
[[nodiscard]] std::string command_line(int argc, const char* const* argv, const std::string& seed);

}  // namespace pd::bench
