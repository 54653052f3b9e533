/// @file
/// Two builds of ours against each other: both programs run in turns on the same pairs, so that a machine that slows
/// down slows both, and every cell is compared with its own twin.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "bench/measure/table.hpp"

namespace pd::bench {

struct CompareSettings {
  std::filesystem::path before;        ///< a pdepth-bench of the older build
  std::filesystem::path after;         ///< and of the newer
  std::vector<std::string> arguments;  ///< of `pairs`, for both
  int rounds = 5;                      ///< in each round both run, in alternating order
};

/// One cell and solver in both builds.
struct Comparison {
  std::string family;
  int vertices = 0;
  std::string depth;
  std::string solver;
  double before_ns = kUnknown;  ///< medians over the rounds
  double after_ns = kUnknown;
  /// After over before, each first divided by Bullet's EPA of its own run where it took part: median, least and largest
  /// over the rounds.
  double ratio = kUnknown;
  double least = kUnknown;
  double largest = kUnknown;
};

/// Pairs the cells of equal rounds. Rows without a twin are left out. Requires as many tables of each kind.
[[nodiscard]] std::vector<Comparison> compare_tables(const std::vector<std::vector<Row>>& before,
                                                     const std::vector<std::vector<Row>>& after);

/// "faster" or "SLOWER" where every round says so, else empty.
[[nodiscard]] std::string_view verdict_of(const Comparison& comparison);

/// Runs both programs and prints the comparison. @param comparisons  is filled
/// @return the exit code.
int run_compare(const CompareSettings& settings, std::vector<Comparison>& comparisons);

}  // namespace pd::bench
