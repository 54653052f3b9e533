/// @file
/// Where the origin falls on the plane of a face of P.
#pragma once

#include "depth/difference/polytope_difference.hpp"

namespace pd::detail {

/// Barycentric coordinates of the origin's projection on the plane of three points with this normal, of any length.
inline void project_origin(const DifferenceVertex (&corners)[3], const Vec3& normal, double (&weights)[3]) {
  double sum = 0;
  for (int i = 0; i < 3; ++i) {
    weights[i] = normal.dot(corners[(i + 1) % 3].x.cross(corners[(i + 2) % 3].x));
    sum += weights[i];
  }
  const double share = 1 / sum;
  for (double& w : weights) w *= share;
}

}  // namespace pd::detail
