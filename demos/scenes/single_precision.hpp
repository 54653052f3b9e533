/// @file
/// Numbers as an engine of single precision holds them.
#pragma once

#include "pd/numeric/vector.hpp"
#include "pd/shape/pose.hpp"

namespace pd::scenes {

/// The float nearest to x. By way of memory: GCC 12 takes two such roundings side by side in one vector for none at all
/// (-O2 and -O3; x and y of a vector come back as they were, z is rounded).
[[nodiscard]] inline double to_single(double x) {
  volatile float rounded = static_cast<float>(x);
  return rounded;
}

[[nodiscard]] inline Vec3 to_single(const Vec3& v) { return {to_single(v.x()), to_single(v.y()), to_single(v.z())}; }

/// Rotation matrix and translation, each number rounded.
[[nodiscard]] inline Pose to_single(const Pose& pose) {
  const Mat3 rotation = pose.rotation().unaryExpr([](double x) { return to_single(x); });
  return Pose::from_trusted_matrix(rotation, to_single(pose.translation()));
}

}  // namespace pd::scenes
