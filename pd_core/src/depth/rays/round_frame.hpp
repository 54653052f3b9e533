/// @file
/// A linear frame in which the difference of two polytopes is about as wide in all directions.
///
/// Directions that cover the sphere see nothing of a slab but its two faces, until they are as close together as the
/// slab is thin. Cones stay cones under a linear map, so that a covering may be laid out in this frame.
#pragma once

#include <algorithm>
#include <cmath>

#include "pd/numeric/vector.hpp"
#include "shape/hull/polytope_storage.hpp"
#include "shape/posed_pair.hpp"

namespace pd::detail {

/// L, lower triangular, with L L^T about the second moments of P; the identity where P is thicker than a thousandth of
/// its length, or where squares leave the range of doubles.
inline Mat3 round_frame(const PosedPair& pair) {
  constexpr double kFlat = 0x1p-20;        // a thousandth, squared
  constexpr double kThinnest = 0x1p-1020;  // of squared lengths
  const auto moments_of = [](const ConvexPolytope& body, const Pose& pose) {
    return Mat3(pose.rotation() * body.storage().second_moments * pose.rotation().transpose());
  };
  Mat3 c = moments_of(pair.a(), pair.pose_a()) + moments_of(pair.b(), pair.pose_b());
  const double size = c.diagonal().maxCoeff();
  if (!(size > 0 && std::isfinite(size))) return Mat3::Identity();
  c /= size;
  Mat3 l = Mat3::Zero();
  for (int k = 0; k < 3; ++k) {
    for (int i = k; i < 3; ++i) {
      double rest = c(i, k);
      for (int j = 0; j < k; ++j) rest -= l(i, j) * l(k, j);
      l(i, k) = i == k ? std::sqrt(std::max(rest, kThinnest)) : rest / l(k, k);
    }
  }
  const double thinnest = l.diagonal().minCoeff();
  return l.allFinite() && thinnest * thinnest < kFlat ? l : Mat3(Mat3::Identity());
}

}  // namespace pd::detail
