/// @file
/// Points, directions and matrices in R^D, 2 <= D <= 5.
///
/// Unaligned types: their size and alignment do not depend on the instruction set that a translation unit is compiled
/// for.
#pragma once

#include <Eigen/Core>

#include "pd/numeric/language.hpp"

namespace pd::dimension {

inline constexpr int kMinDimension = 2;
inline constexpr int kMaxDimension = 5;
/// This value of D means that the dimension is known at run time. The sources of the module compute with such vectors
/// and matrices, so that they are compiled once and not for each D. They hold kMaxDimension numbers a column, never on
/// the heap.
inline constexpr int kAnyDimension = Eigen::Dynamic;
/// The rows of a vector that is made without a size: D, or none where the dimension is known at run time only.
template <int D>
inline constexpr int kInitialSize = D == kAnyDimension ? 0 : D;

template <int D>
using Vector = Eigen::Matrix<double, D, 1, Eigen::DontAlign, D == kAnyDimension ? kMaxDimension : D, 1>;
template <int D>
using Matrix = Eigen::Matrix<double, D, D, Eigen::DontAlign, D == kAnyDimension ? kMaxDimension : D,
                             D == kAnyDimension ? kMaxDimension : D>;

}  // namespace pd::dimension
