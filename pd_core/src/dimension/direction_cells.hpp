/// @file
/// A grid on the faces of the cube about the origin: which cell a direction falls into, in O(1).
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "dimension/any_dimension.hpp"

namespace pd::dimension::detail {

class DirectionCells {
 public:
  /// About `cells` cells in all, at least one a face of the cube.
  DirectionCells(int dimension, double cells)
      : dimension_(dimension),
        along_(std::max<std::int64_t>(
            1, static_cast<std::int64_t>(std::round(std::pow(cells / (2 * dimension), 1.0 / (dimension - 1)))))) {}

  [[nodiscard]] std::int64_t size() const {
    std::int64_t r = 2 * dimension_;
    for (int k = 1; k < dimension_; ++k) r *= along_;
    return r;
  }

  /// The axis along which the direction is longest, and the cell on that face.
  struct Place {
    std::int64_t cell;
    int axis;
  };

  /// Of a nonzero direction.
  [[nodiscard]] std::int64_t cell(const AnyVector& direction) const { return place(direction).cell; }

  [[nodiscard]] Place place(const AnyVector& direction) const {
    // Without branches on the axis, which cannot be foretold.
    int axis = 0;
    double longest = std::abs(direction[0]);
    for (int k = 1; k < dimension_; ++k) {
      axis += (k - axis) & -static_cast<int>(std::abs(direction[k]) > longest);
      longest = std::max(longest, std::abs(direction[k]));
    }
    const double half = 0.5 * static_cast<double>(along_);
    const double scale = half / longest;
    std::int64_t cell = 2 * axis + (direction[axis] > 0 ? 1 : 0);
    for (int k = 0; k + 1 < dimension_; ++k) {
      // A direction that is zero or not a number has no place; any will do.
      const double at = direction[k + static_cast<int>(k >= axis)] * scale + half;
      const std::int64_t i = at >= 0 ? std::min(static_cast<std::int64_t>(at), along_ - 1) : 0;
      cell = cell * along_ + i;
    }
    return {cell, axis};
  }

  /// Of a cell, where its face of the cube is at distance 1: a box of this half-width about `middle`.
  [[nodiscard]] double half_width() const { return 1 / static_cast<double>(along_); }
  [[nodiscard]] int axis(std::int64_t cell) const {
    for (int k = 1; k < dimension_; ++k) cell /= along_;
    return static_cast<int>(cell / 2);
  }

  /// The middle of a cell, of length 1 to sqrt(dimension).
  [[nodiscard]] AnyVector middle(std::int64_t cell) const {
    std::int64_t steps[kMaxDimension];
    for (int k = dimension_ - 1; k > 0; --k) {
      steps[k] = cell % along_;
      cell /= along_;
    }
    AnyVector r(dimension_);
    const int axis = static_cast<int>(cell / 2);
    int next = 1;
    for (int k = 0; k < dimension_; ++k) {
      if (k == axis) {
        r[k] = (cell & 1) != 0 ? 1 : -1;
      } else {
        r[k] = (2 * static_cast<double>(steps[next++]) + 1) / static_cast<double>(along_) - 1;
      }
    }
    return r;
  }

 private:
  int dimension_;
  std::int64_t along_;
};

}  // namespace pd::dimension::detail
