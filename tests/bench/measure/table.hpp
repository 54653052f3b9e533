/// @file
/// What was measured, for the terminal and as CSV.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "pd/numeric/expected.hpp"

namespace pd::bench {

inline constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// One solver in one cell. Times are of one call.
struct Row {
  std::string family;
  int vertices = 0;
  std::string depth;
  std::string solver;
  int pairs = 0;
  double p50_ns = kUnknown;
  double p99_ns = kUnknown;
  double ratio_to_bullet = kUnknown;  ///< p50 over that of Bullet's EPA on the same pairs
  int wrong = 0;
  double allocations = 0;      ///< in one call, mean
  double worst_error = 0;      ///< |depth - truth| / truth
  double supports = kUnknown;  ///< in one call, mean
  double max_ns = kUnknown;    ///< the slowest pair
};

/// Sets ratio_to_bullet of rows that belong to one cell, from the row of the solver `baseline`.
void set_ratios(std::vector<Row>& cell, std::string_view baseline);

/// A header line, then the rows of a cell under it. A row with wrong answers is marked.
void print_header();
void print_rows(const std::vector<Row>& cell);

/// Geometric means of the ratios, and the sum of wrong answers, of each solver over all cells.
void print_summary(const std::vector<Row>& rows);

/// One of ours beside the peers that answer the same question.
struct Contest {
  std::string ours;
  std::vector<std::string> peers;  ///< none: every solver that is not ours
};

/// The fastest peer that answered all of a cell's questions, none of them wrong.
struct BestPeer {
  const Row* ours = nullptr;
  const Row* peer = nullptr;  ///< null: there is none

  [[nodiscard]] bool lost() const { return peer != nullptr && (ours->wrong > 0 || ours->p50_ns > peer->p50_ns); }
};

/// One for each cell that `contest.ours` ran in, in the order of the rows. Refers to `rows`.
[[nodiscard]] std::vector<BestPeer> best_peers(const std::vector<Row>& rows, const Contest& contest);
/// Each cell's, and how many cells the peer is faster in.
void print_contest(const std::vector<Row>& rows, const Contest& contest);

/// Columns family,vertices,depth,solver,pairs,p50_ns,p99_ns,ratio_to_bullet,wrong,allocations; an unknown ratio is
/// empty.
[[nodiscard]] std::string to_csv(const std::vector<Row>& rows);
/// Reads what `to_csv` wrote. ErrorCode::bad_value with the line's number where it is something else.
[[nodiscard]] Expected<std::vector<Row>> from_csv(const std::string& text);

/// Writes a text file (folders are made), or says why not.
[[nodiscard]] bool write_text(const std::filesystem::path& path, const std::string& text);

}  // namespace pd::bench
