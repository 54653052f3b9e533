/// @file
/// Inverses of D x D matrices.
#pragma once

#include <optional>

#include "pd/dimension/vector.hpp"

namespace pd::dimension {

/// matrix^-1. Requires a regular matrix: whether it is regular is not checked. O(D^3).
template <int D>
[[nodiscard]] Matrix<D> inverse_of(const Matrix<D>& matrix);

/// matrix^-1, or nothing where elimination with full pivoting finds a rank below D (a pivot of at most D units in the
/// last place of the largest one). O(D^3).
template <int D>
[[nodiscard]] std::optional<Matrix<D>> inverse_if_regular(const Matrix<D>& matrix);

}  // namespace pd::dimension
