/// @file
/// How narrow a bracket is asked for: a share of the bodies' size, or a length.
#pragma once

#include <algorithm>

namespace pd::detail {

struct BracketWidth {
  double of_size = 0;  ///< in units of the largest |coordinate| seen
  double length = 0;   ///< in the unit of the input; the wider of both is enough

  [[nodiscard]] double limit(double largest) const { return std::max(of_size * largest, length); }
};

}  // namespace pd::detail
