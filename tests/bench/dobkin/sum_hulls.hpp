/// @file
/// The hull of all differences of two polytopes' vertices by other people's programs: what a directional depth would
/// cost that builds P.
#pragma once

#include <vector>

#include "pd/shape/convex_polytope.hpp"

namespace pd::bench {

struct TimedHull {
  double seconds;
  int vertices;
};

[[nodiscard]] TimedHull qhull_hull(const std::vector<Vec3>& points);
#ifdef PD_BENCH_WITH_CGAL
[[nodiscard]] TimedHull cgal_hull(const std::vector<Vec3>& points);
#endif

}  // namespace pd::bench
