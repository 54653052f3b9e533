/// @file
/// Cold single pairs: every solver on the same bodies where they stand, interleaved in one process.
///
/// Cold means that no solver keeps anything from one call to the next (caches are hot: each pair is solved many times).
/// A pair's time is the least mean of its rounds; p50 and p99 are taken over the pairs.
#pragma once

#include "bench/measure/table.hpp"
#include "bench/pairs/pair_source.hpp"

namespace pd::bench {

/// A solver that needs more than this for a pair sits out the rest of the cell and the larger ones like it.
inline constexpr double kSlowNs = 5e7;

struct PairsSettings {
  std::vector<Cell> cells;
  int pairs = 72;  ///< in each cell
  std::uint64_t seed = 0;
};

/// What the rounds of one draw add to a row.
class Tally {
 public:
  void add(double ns, double allocations, double supports, bool wrong, double error);
  [[nodiscard]] Row row() const;  ///< without its cell's names
  [[nodiscard]] int count() const { return static_cast<int>(times_.size()); }

 private:
  std::vector<double> times_;
  double allocations_ = 0;
  double supports_ = 0;
  double worst_error_ = 0;
  int wrong_ = 0;
};

/// Runs and judges every solver on one draw and adds to `tallies` (one for each solver; those of solvers that sit out
/// stay as they are). A solver slower than `slow_ns` is run twice and sits out from then on. Draws whose bodies do not
/// overlap are refused: false.
bool measure_draw(const Draw& draw, Solvers& solvers, double slow_ns, std::vector<char>& sits_out,
                  std::vector<Tally>& tallies);

/// The rows of one cell, with their ratios to `baseline`: solvers that ran at least once.
[[nodiscard]] std::vector<Row> rows_of(const Solvers& solvers, const std::vector<Tally>& tallies,
                                       std::string_view family, int vertices, std::string_view depth,
                                       std::string_view baseline);

/// All cells, printed as they come. @return the rows.
[[nodiscard]] std::vector<Row> run_pairs(const PairsSettings& settings, Solvers& solvers);

}  // namespace pd::bench
