/// @file
/// `pdepth-bench dobkin`: the bounds of [D] measured, claim by claim.
///
/// [D] Dobkin, Hershberger, Kirkpatrick, Suri, "Computing the intersection-depth of polyhedra", 1993.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bench/measure/claims.hpp"
#include "bench/report/report_target.hpp"

namespace pd::bench {

struct DobkinSettings {
  bool full = false;  ///< up to 2^20 vertices; otherwise under a minute
  std::uint64_t seed = 1;
  std::string out;                    ///< folder for dobkin.csv, dobkin_points.csv and dobkin.md; or empty
  std::vector<std::string> chapters;  ///< names of chapters; empty = all
  std::vector<std::string> families;  ///< of the hierarchy chapter: names of its bodies; empty = all
  ReportTarget report = {};
};

/// Counted steps of the descent of two hierarchies, the worst direction searched for, answers against the portal
/// search.
void measure_hierarchy(const DobkinSettings& settings, ClaimTable& table);
/// Probes of the search in two convex polygons; work of the medial axis; answers against the scan of all edges.
void measure_convex_polygons(const DobkinSettings& settings, ClaimTable& table);

/// Supports and directional depth of large polytopes beside the sampled climb; of small ones beside their whole
/// difference.
void measure_against_climb(const DobkinSettings& settings, ClaimTable& table);
/// The implicit boundary of [D] section 4 beside GEOS, Boost.Geometry and CGAL, where they are; holes and memory.
void measure_polygon_boundary(const DobkinSettings& settings, ClaimTable& table);
/// The search in two convex polygons beside two random binary searches: the bare cost of finding something among so
/// many.
void measure_searches(const DobkinSettings& settings, ClaimTable& table);
/// Directional queries after preprocessing beside ray casts.
void measure_polygon_rays(const DobkinSettings& settings, ClaimTable& table);

/// @return the exit code, as `run_agarwal`.
int run_dobkin(const DobkinSettings& settings);
[[nodiscard]] std::string dobkin_chapters();
/// Names of the hierarchy chapter's bodies.
[[nodiscard]] const std::vector<std::string>& hierarchy_families();

}  // namespace pd::bench
