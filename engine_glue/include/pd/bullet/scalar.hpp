/// @file
/// The seam between Bullet's scalar type (float or double, `BT_USE_DOUBLE_PRECISION`) and the doubles of pd_core. No
/// other file of the project converts between the two.
///
/// Going in is exact: every float is a double. Coming out rounds to the nearest btScalar.
#pragma once

#include <LinearMath/btTransform.h>

#include "pd/numeric/vector.hpp"
#include "pd/shape/pose.hpp"

namespace pd {

[[nodiscard]] inline Vec3 to_pd(const btVector3& v) {
  return {static_cast<double>(v.x()), static_cast<double>(v.y()), static_cast<double>(v.z())};
}

/// The vector as four numbers, the last one 0.
inline void to_pd(const btVector3& v, double (&out)[4]) {
  out[0] = static_cast<double>(v.x());
  out[1] = static_cast<double>(v.y());
  out[2] = static_cast<double>(v.z());
  out[3] = 0;
}

[[nodiscard]] inline Mat3 to_pd(const btMatrix3x3& m) {
  Mat3 result;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      result(i, j) = static_cast<double>(m[i][j]);
    }
  }
  return result;
}

/// Bullet's basis is a rotation only up to its own rounding; it is taken as it stands. Requires finite numbers.
[[nodiscard]] inline Pose to_pd(const btTransform& transform) {
  return Pose::from_trusted_matrix(to_pd(transform.getBasis()), to_pd(transform.getOrigin()));
}

/// The vector is stored at once. A processor waits when it loads a vector that was stored number by number just before.
[[nodiscard]] inline btVector3 to_bullet(const Vec3& v) {
  typedef btScalar FourNumbers __attribute__((vector_size(4 * sizeof(btScalar))));
  const FourNumbers numbers = {static_cast<btScalar>(v.x()), static_cast<btScalar>(v.y()), static_cast<btScalar>(v.z()),
                               0};
  btVector3 out;
  __builtin_memcpy(out.m_floats, &numbers, sizeof(numbers));
  return out;
}

/// True if every number of the transform is finite.
[[nodiscard]] inline bool is_finite(const btTransform& transform) {
  // A sum of products with 0 is 0 exactly when all are finite: one test instead of twelve.
  btScalar sum = 0;
  for (int i = 0; i < 3; ++i) {
    sum += transform.getBasis()[i].x() * btScalar(0) + transform.getBasis()[i].y() * btScalar(0) +
           transform.getBasis()[i].z() * btScalar(0) + transform.getOrigin()[i] * btScalar(0);
  }
  return sum == btScalar(0);
}

}  // namespace pd
