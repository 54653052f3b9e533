/// @file
/// `pdepth-bench arya`: the bounds of [M] measured, claim by claim, and ratios to peers in one run.
///
/// [M] Arya, da Fonseca, Mount, "Approximate convex intersection detection with applications to width and Minkowski
/// sums", 2018.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bench/measure/claims.hpp"
#include "bench/report/report_target.hpp"
#include "pd/dimension/directional_width.hpp"

namespace pd::bench {

struct AryaSettings {
  bool full = false;  ///< the sizes of the paper's table; otherwise under a minute
  std::uint64_t seed = 1;
  int pairs = 0;  ///< bodies or pairs a promise is tried on for d <= 3; 0 = 1e5 when full, else some hundreds
  /// Behind what the promises ask; by default the kernel, and in `intersection` each in turn.
  std::optional<dimension::Backend> backend = {};
  std::string out;                    ///< folder for arya.csv, arya_points.csv, arya.md and the plots; or empty
  std::vector<std::string> chapters;  ///< names of chapters; empty = all
  ReportTarget report = {};
};

[[nodiscard]] constexpr std::string_view to_string(dimension::Backend backend) {
  constexpr std::string_view kNames[] = {"exact", "kernel", "macbeath"};
  return kNames[static_cast<int>(backend)];
}

/// Sizes of kernels and of their structures against (1/epsilon)^((d-1)/2); work of queries.
void measure_arya_sizes(const AryaSettings& settings, ClaimTable& table);
/// Promises on random and adversarial bodies: one error beyond epsilon is a wrong answer.
void measure_arya_promises(const AryaSettings& settings, ClaimTable& table);
/// The same for Lemmas 6, 13, 16 and Theorems 2, 3.
void measure_arya_theorems(const AryaSettings& settings, ClaimTable& table);
/// Kernels of many points against plain passes of dot products; enclosing ellipsoids.
void measure_arya_kernels(const AryaSettings& settings, ClaimTable& table);
/// Width against Qhull's hull of the same points.
void measure_arya_width(const AryaSettings& settings, ClaimTable& table);

/// Intersection queries: their promise.
void measure_arya_intersection(const AryaSettings& settings, ClaimTable& table);
/// Their calls, and their time against GJK over hulls.
void measure_arya_queries(const AryaSettings& settings, ClaimTable& table);
/// The hierarchy of Macbeath regions: nodes, degrees, visits.
void measure_arya_macbeath(const AryaSettings& settings, ClaimTable& table);
/// Sizes of approximate Minkowski sums.
void measure_arya_sums(const AryaSettings& settings, ClaimTable& table);

/// @return the exit code, as `run_agarwal`.
int run_arya(const AryaSettings& settings);
[[nodiscard]] std::string arya_chapters();

}  // namespace pd::bench
