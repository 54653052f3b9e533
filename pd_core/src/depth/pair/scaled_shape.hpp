/// @file
/// Bodies times a power of two: smooth pairs of any size are answered at size 1, where squares and products of lengths
/// neither over- nor underflow.
#pragma once

#include "pd/depth/depth_answer.hpp"
#include "pd/shape/convex_shape.hpp"

namespace pd::detail {

/// The exponent of the pair's size where doubles lack room for products of lengths, else 0: nothing need be scaled.
[[nodiscard]] int extreme_exponent(const PosedShape& a, const PosedShape& b);

/// Times 2^exponent. Sizes that fall below 2^-900 are raised to it, of spheres lowered to 0: next to a pair of size 1
/// that is nothing. Builds a polytope's hull anew where a coordinate is rounded.
[[nodiscard, gnu::cold]] ConvexShape scaled(const ConvexShape& shape, int exponent);

/// Two bodies times 2^-exponent about A's translation, which comes to lie at the origin: what is far away may be small.
/// Holds what its posed shapes refer to.
class ScaledPair {
 public:
  ScaledPair(const PosedShape& a, const PosedShape& b, int exponent);
  ScaledPair(const ScaledPair&) = delete;
  ScaledPair& operator=(const ScaledPair&) = delete;

  [[nodiscard]] PosedShape a() const { return {&a_, pose_a_}; }
  [[nodiscard]] PosedShape b() const { return {&b_, pose_b_}; }

 private:
  ConvexShape a_;
  ConvexShape b_;
  Pose pose_a_;
  Pose pose_b_;
};

/// Each coordinate times 2^exponent.
[[nodiscard]] Vec3 times_power(const Vec3& v, int exponent);

/// x >= 0 times 2^exponent, rounded down or up where that is subnormal.
[[nodiscard]] double times_power_down(double x, int exponent);
[[nodiscard]] double times_power_up(double x, int exponent);

/// Every length and point of an answer times 2^exponent, brackets rounded outwards where that is subnormal.
void scale_answer(PenetrationDepth& answer, int exponent);

}  // namespace pd::detail
