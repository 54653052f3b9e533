/// @file
/// Affine maps x -> linear x + translation, and what they do to support functions.
#pragma once

#include "pd/dimension/matrix_inverse.hpp"
#include "pd/dimension/vector.hpp"

namespace pd::dimension {

template <int D>
struct AffineMap {
  Matrix<D> linear = Matrix<D>::Identity(kInitialSize<D>, kInitialSize<D>);
  Vector<D> translation = Vector<D>::Zero(kInitialSize<D>);

  [[nodiscard]] Vector<D> apply(const Vector<D>& point) const { return linear * point + translation; }

  /// h_{LK + t}(v) = h_K(L^T v) + <t, v>: the direction in which K is asked for the image's extreme point in v.
  [[nodiscard]] Vector<D> pull_back(const Vector<D>& direction) const { return linear.transpose() * direction; }

  /// Requires a regular `linear`.
  [[nodiscard]] AffineMap inverse() const {
    const Matrix<D> back = inverse_of<D>(linear);
    return {back, -(back * translation)};
  }

  /// First `inner`, then this map.
  [[nodiscard]] AffineMap after(const AffineMap& inner) const {
    return {linear * inner.linear, apply(inner.translation)};
  }
};

}  // namespace pd::dimension
