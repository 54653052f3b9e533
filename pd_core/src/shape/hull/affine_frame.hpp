/// @file
/// The affine dimension of a point set, decided exactly, with points that span it.
#pragma once

#include <array>

#include "shape/hull/hull_points.hpp"

namespace pd::detail {

/// `dimension` + 1 affinely independent points; the first two are the lexicographically least and greatest. Of equal
/// points the one with the lowest index is taken.
struct AffineFrame {
  int dimension = 0;
  std::array<int, 4> points{-1, -1, -1, -1};
};

/// Requires at least one point. Time O(n); exact arithmetic runs over all points only where they look flat in doubles.
[[nodiscard]] AffineFrame find_affine_frame(const HullPoints& points);

}  // namespace pd::detail
