/// @file
/// The mass matrix of a body of Bullet for `ImpulseNewton`.
#pragma once

#include <LinearMath/btMatrix3x3.h>

#include <Eigen/LU>
#include <cmath>

#include "stack/impulse_newton.hpp"

namespace pd::detail {

[[nodiscard]] inline ImpulseNewton::Vector6 six(const btVector3& linear, const btVector3& angular) {
  ImpulseNewton::Vector6 result;
  for (int i = 0; i < 3; ++i) {
    result[i] = static_cast<double>(linear[i]);
    result[3 + i] = static_cast<double>(angular[i]);
  }
  return result;
}

/// A body's mass matrix and its inverse, and its directions that can move (1) or cannot (0), whose mass is 1 and of no
/// account.
struct BodyInertia {
  ImpulseNewton::Matrix6 mass = ImpulseNewton::Matrix6::Identity();
  ImpulseNewton::Matrix6 inverse = ImpulseNewton::Matrix6::Identity();
  ImpulseNewton::Vector6 moves = ImpulseNewton::Vector6::Zero();
};

/// @param inverse_mass  along each axis
/// @param inverse  inertia, in the world
[[nodiscard]] inline BodyInertia body_inertia(const btVector3& inverse_mass, const btMatrix3x3& inverse,
                                              const btVector3& angular_factor) {
  BodyInertia result;
  Eigen::Matrix3d turning;
  for (int i = 0; i < 3; ++i) {
    const double share = static_cast<double>(inverse_mass[i]);
    if (share > 0) {
      result.mass(i, i) = 1 / share;
      result.inverse(i, i) = share;
      result.moves[i] = 1;
    }
    for (int j = 0; j < 3; ++j) {
      turning(i, j) =
          static_cast<double>(inverse[i][j]) * std::sqrt(static_cast<double>(angular_factor[i] * angular_factor[j]));
    }
  }
  for (int i = 0; i < 3; ++i) {
    if (turning(i, i) > 0) {
      result.moves[3 + i] = 1;
      continue;
    }
    turning.row(i).setZero();
    turning.col(i).setZero();
    turning(i, i) = 1;
  }
  result.mass.bottomRightCorner<3, 3>() = turning.inverse();
  result.inverse.bottomRightCorner<3, 3>() = turning;
  return result;
}

}  // namespace pd::detail
