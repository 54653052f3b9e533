// CGAL's approximate minimum ellipsoid. The package is GPL: a peer of the bench, built only where it is found.
#include <CGAL/Approximate_min_ellipsoid_d.h>
#include <CGAL/Approximate_min_ellipsoid_d_traits_3.h>
#include <CGAL/Cartesian.h>
#include <CGAL/Gmpzf.h>

#include "bench/arya/ellipsoid_peers.hpp"

namespace pd::bench {

namespace {

template <class Exact>
PeerEllipsoid ellipsoid(const std::vector<dimension::Vector<3>>& points, double epsilon) {
  using Kernel = CGAL::Cartesian<double>;
  using Traits = CGAL::Approximate_min_ellipsoid_d_traits_3<Kernel, Exact>;
  std::vector<Kernel::Point_3> given;
  given.reserve(points.size());
  for (const dimension::Vector<3>& p : points) given.emplace_back(p[0], p[1], p[2]);
  Traits traits;
  const CGAL::Approximate_min_ellipsoid_d<Traits> found(epsilon, given.begin(), given.end(), traits);
  return {found.is_full_dimensional(), found.achieved_epsilon()};
}

}  // namespace

PeerEllipsoid cgal_ellipsoid(const std::vector<dimension::Vector<3>>& points, double epsilon) {
  return ellipsoid<CGAL::Gmpzf>(points, epsilon);
}
PeerEllipsoid cgal_ellipsoid_in_doubles(const std::vector<dimension::Vector<3>>& points, double epsilon) {
  return ellipsoid<double>(points, epsilon);
}

}  // namespace pd::bench
