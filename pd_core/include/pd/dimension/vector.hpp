/// @file
/// Points, directions and matrices in R^D, 2 <= D <= 5.
///
/// Unaligned types: their size and alignment do not depend on the instruction set that a translation unit is compiled
/// for.
#pragma once

#include <Eigen/Core>

namespace pd::dimension {

inline constexpr int kMinDimension = 2;
inline constexpr int kMaxDimension = 5;

template <int D>
using Vector = Eigen::Matrix<double, D, 1, Eigen::DontAlign>;
template <int D>
using Matrix = Eigen::Matrix<double, D, D, Eigen::DontAlign>;

}  // namespace pd::dimension
