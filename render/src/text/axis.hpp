/// @file
/// One axis of a chart: its range, its ticks and the words at them.
#pragma once

#include <string>
#include <vector>

#include "pd/render/chart.hpp"

namespace pd::render::detail {

struct Tick {
  double value;
  std::string text;  ///< empty: a minor tick
};

/// Maps values to [0, 1].
struct Axis {
  Scale scale;
  double lower;
  double upper;
  std::vector<Tick> ticks;

  [[nodiscard]] double place(double value) const;
};

/// Ticks at 1, 2, 5 times powers of ten, computed as whole multiples of the step so that no tick reads
/// 0.30000000000000004; decades (with 2..9 between them unlabelled) on a logarithmic axis.
/// @param lower, upper  finite, positive on a logarithmic axis.
/// @param wanted  about how many labelled ticks.
Axis make_axis(Scale scale, double lower, double upper, bool from_zero, int wanted);

}  // namespace pd::render::detail
