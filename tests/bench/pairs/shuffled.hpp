/// @file
/// Pairs of mixed kinds in shuffled order, each asked once: what a query costs when its bodies, and the code that it
/// runs through, have left the caches.
///
/// Boxes, hulls of 8 to 128 vertices, spheres, capsules, cylinders and triangles, each pair with bodies of its own,
/// overlapping by 1 or 10 % of the smaller one. Each solver asks all pairs three times: each pair several times in a
/// row, the least of these (hot), each once (shuffled), and each once with other data read before it.
#pragma once

#include "bench/peers/solver.hpp"

namespace pd::bench {

struct ShuffledSettings {
  int pairs = 20'000;
  int other_megabytes = 4;  ///< read between two queries
  std::uint64_t seed = 0;
};

/// Nanoseconds of one query, means over all pairs that a solver takes.
struct ShuffledRow {
  std::string solver;
  int pairs = 0;
  double hot_ns = 0;
  double shuffled_ns = 0;
  double other_data_ns = 0;
};

/// Measures every solver on its pairs, and prints a line for each.
[[nodiscard]] std::vector<ShuffledRow> run_shuffled(const ShuffledSettings& settings, Solvers& solvers);

/// Columns solver,pairs,hot_ns,shuffled_ns,other_data_ns.
[[nodiscard]] std::string to_csv(const std::vector<ShuffledRow>& rows);

}  // namespace pd::bench
