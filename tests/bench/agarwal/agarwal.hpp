/// @file
/// `pdepth-bench agarwal`: the bounds of [A] measured, claim by claim, on the families of
/// `scenes/agarwal_families.hpp`.
///
/// [A] Agarwal, Guibas, Har-Peled, Rabinovitch, Sharir, "Penetration depth of two convex polytopes in 3D", 2000.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "bench/measure/claims.hpp"
#include "bench/report/report_target.hpp"
#include "scenes/agarwal_families.hpp"

namespace pd::bench {

/// The counter of which one is too many: it decides the exit code.
inline constexpr std::string_view kWrongAnswers = "wrong answers";

struct AgarwalSettings {
  bool quick = false;  ///< under a minute: smaller sizes, fewer pairs
  std::uint64_t seed = 1;
  std::string out;  ///< folder for agarwal.csv, agarwal_points.csv, agarwal.md and the plots; or empty
  std::vector<std::string> chapters;  ///< names of chapters; empty = all
  ReportTarget report = {};
  std::int64_t pairs = 0;  ///< of the exactness chapter; 0 = 100,000, quick 2,000
};

/// The chapters, each a few claims.
void measure_sizes(const AgarwalSettings& settings, ClaimTable& table);
void measure_search(const AgarwalSettings& settings, ClaimTable& table);
void measure_decomposition(const AgarwalSettings& settings, ClaimTable& table);
void measure_approximate(const AgarwalSettings& settings, ClaimTable& table);
void measure_shallow(const AgarwalSettings& settings, ClaimTable& table);
void measure_non_convex(const AgarwalSettings& settings, ClaimTable& table);
void measure_roofs(const AgarwalSettings& settings, ClaimTable& table);
void measure_exactness(const AgarwalSettings& settings, ClaimTable& table);

/// All chapters asked for; prints the table as it grows and writes the files. @return the exit code: 0, or 1 where an
/// answer was wrong or a file could not be written, 2 for an unknown chapter. A bound that fails is a result, no error.
int run_agarwal(const AgarwalSettings& settings);

/// The names of the chapters, for the help.
[[nodiscard]] std::string agarwal_chapters();

/// Processor time of the fastest run of each task in nanoseconds: they run in turns, `rounds` times, and once more
/// beforehand to grow their buffers where `warm_up` is set. What other programs do does not count.
[[nodiscard]] std::vector<double> least_times_ns(std::span<const std::function<void()>> tasks, int rounds,
                                                 bool warm_up = true);

/// low, 2 low, 4 low, ... up to high.
[[nodiscard]] std::vector<int> doublings(int low, int high);

/// The quadratic families of a smooth outline, without tilt.
[[nodiscard]] std::span<const scenes::AgarwalFamily> smooth_families();
[[nodiscard]] std::span<const scenes::AgarwalFamily> tilted_families();

}  // namespace pd::bench
