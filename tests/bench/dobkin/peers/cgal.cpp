// CGAL's reduced convolution, with its exact kernel. The package is GPL: a peer of the bench, built only where it is
// found.
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/Polygon_2.h>
#include <CGAL/Polygon_with_holes_2.h>
#include <CGAL/minkowski_sum_2.h>

#include <cmath>

#include "bench/dobkin/polygon_peers.hpp"

namespace pd::bench {

PeerSum cgal_sum(const Polygon& p, const Polygon& q) {
  using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;
  using Ring = CGAL::Polygon_2<Kernel>;
  Ring body, negated;
  for (int v = p.ring_begin(0); v < p.ring_end(0); ++v) body.push_back({p.point(v)[0], p.point(v)[1]});
  for (int v = q.ring_begin(0); v < q.ring_end(0); ++v) negated.push_back({-q.point(v)[0], -q.point(v)[1]});
  const auto sum = CGAL::minkowski_sum_by_reduced_convolution_2(body, negated);
  PeerSum result;
  result.answered = true;
  result.holes = static_cast<int>(sum.number_of_holes());
  result.area = std::abs(CGAL::to_double(sum.outer_boundary().area()));
  for (auto hole = sum.holes_begin(); hole != sum.holes_end(); ++hole) {
    result.area -= std::abs(CGAL::to_double(hole->area()));
  }
  return result;
}

}  // namespace pd::bench
