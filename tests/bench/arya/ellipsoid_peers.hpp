/// @file
/// Enclosing ellipsoids by other libraries, in terms of the bench.
#pragma once

#include <vector>

#include "pd/dimension/vector.hpp"

namespace pd::bench {

struct PeerEllipsoid {
  bool answered = false;
  /// On points lifted by a coordinate of 1 and weighed, as (D + 1) (1 + this) bounds their squared lengths.
  double achieved_epsilon = 0;
};

/// CGAL's Approximate_min_ellipsoid_d, certified by its faster exact number type.
PeerEllipsoid cgal_ellipsoid(const std::vector<dimension::Vector<3>>& points, double epsilon);
/// The same with doubles in place of exact numbers: it certifies nothing then.
PeerEllipsoid cgal_ellipsoid_in_doubles(const std::vector<dimension::Vector<3>>& points, double epsilon);

}  // namespace pd::bench
