/// @file
/// Bodies times a power of two: smooth pairs of any size are answered at size 1, where squares and products of lengths
/// neither over- nor underflow.
#pragma once

#include "pd/depth/depth_answer.hpp"
#include "pd/shape/convex_shape.hpp"

namespace pd::detail {

/// The exponent of the pair's size where doubles lack room for products of lengths, else 0: nothing need be scaled.
[[nodiscard]] int extreme_exponent(const PosedShape& a, const PosedShape& b);

/// Times 2^exponent. Sizes that fall below 2^-900 are raised to it: next to a pair of size 1 that is nothing. Builds
/// a polytope's hull anew.
[[nodiscard]] ConvexShape scaled(const ConvexShape& shape, int exponent);

/// Every length and point of an answer times 2^exponent, brackets rounded outwards where that is subnormal.
void scale_answer(PenetrationDepth& answer, int exponent);

}  // namespace pd::detail
