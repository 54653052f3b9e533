// CGAL's hull of points in space, with its kernel of exact predicates. The package is GPL: a peer of the bench, built
// only where it is found.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/convex_hull_3.h>

#include "bench/dobkin/sum_hulls.hpp"
#include "bench/measure/stopwatch.hpp"

namespace pd::bench {

TimedHull cgal_hull(const std::vector<Vec3>& points) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  std::vector<Kernel::Point_3> all;
  for (const Vec3& x : points) all.emplace_back(x.x(), x.y(), x.z());
  CGAL::Surface_mesh<Kernel::Point_3> hull;
  const auto begin = Clock::now();
  CGAL::convex_hull_3(all.begin(), all.end(), hull);
  return {elapsed_ns(begin, Clock::now()) * 1e-9, static_cast<int>(hull.number_of_vertices())};
}

}  // namespace pd::bench
