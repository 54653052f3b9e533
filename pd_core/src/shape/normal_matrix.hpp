/// @file
/// How a pose turns normals.
#pragma once

#include <Eigen/Geometry>

#include "pd/shape/pose.hpp"

namespace pd::detail {

/// The cofactors of a pose's matrix: they turn normals also where the stored matrix is a rotation only up to rounding.
inline Mat3 normal_matrix(const Pose& pose) {
  const Mat3& r = pose.rotation();
  Mat3 m;
  m.row(0) = r.row(1).cross(r.row(2));
  m.row(1) = r.row(2).cross(r.row(0));
  m.row(2) = r.row(0).cross(r.row(1));
  return m;
}

}  // namespace pd::detail
