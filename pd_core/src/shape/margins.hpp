/// @file
/// The margins of two rounded bodies: radii of the balls added to their cores.
#pragma once

namespace pd::detail {

struct Margins {
  double a = 0;
  double b = 0;
  [[nodiscard]] double both() const { return a + b; }
};

}  // namespace pd::detail
