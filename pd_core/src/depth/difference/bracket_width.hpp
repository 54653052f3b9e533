/// @file
/// How narrow a bracket is asked for: a share of the size of the numbers that doubles work with, or a length.
#pragma once

#include <algorithm>

namespace pd::detail {

struct BracketWidth {
  /// The unit is the size: the reach of the difference of two polytopes, else the largest |coordinate| seen.
  double of_size = 0;
  /// The unit is that of the input; the wider of both is enough.
  double length = 0;

  /// Around the cores: relative errors are of the distance, or of the depth, that is left between the margins.
  double margin = 0;

  [[nodiscard]] double limit(double size) const { return std::max(of_size * size, length); }
  /// Whether the bracket of the cores' distance is within `relative` of what is left of it.
  [[nodiscard]] bool is_within(double relative, double lower, double upper) const {
    if (margin == 0) return upper <= (1 + relative) * lower;
    return upper - lower <= relative * std::max(lower - margin, margin - upper);
  }
};

}  // namespace pd::detail
