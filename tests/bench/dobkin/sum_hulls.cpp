#include "bench/dobkin/sum_hulls.hpp"

#include <string>

#include "bench/measure/stopwatch.hpp"

extern "C" {
#include <libqhull_r/qhull_ra.h>
}

namespace pd::bench {

TimedHull qhull_hull(const std::vector<Vec3>& points) {
  std::vector<double> coordinates;
  for (const Vec3& x : points) coordinates.insert(coordinates.end(), {x.x(), x.y(), x.z()});
  const auto begin = Clock::now();
  qhT context;
  qh_zero(&context, stderr);
  std::string options = "qhull Qt";
  qh_new_qhull(&context, 3, static_cast<int>(points.size()), coordinates.data(), False, options.data(), nullptr,
               stderr);
  const TimedHull hull{elapsed_ns(begin, Clock::now()) * 1e-9, context.num_vertices};
  qh_freeqhull(&context, qh_ALL);
  int current = 0, total = 0;
  qh_memfreeshort(&context, &current, &total);
  return hull;
}

}  // namespace pd::bench
