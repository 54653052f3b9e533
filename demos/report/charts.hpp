/// @file
/// Charts of a page that stand still: bars, and lines on logarithmic axes.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace pd::report {

struct BarChart {
  struct Bar {
    std::string name;
    double value;
    std::string shown;  ///< beside the bar, escaped here
    bool ours = false;
  };
  std::string title;
  std::string text;  ///< below the title
  std::vector<Bar> bars;
  /// Lengths by the logarithm, from the power of ten below the least: for ratios and times. Values of 0 have no bar.
  bool logarithmic = false;
};

/// A list whose items are bars: text on every screen and for readers. Values that are no finite numbers have no bar.
[[nodiscard]] std::string bar_chart(const BarChart& chart);

struct LinePlot {
  struct Line {
    std::string name;
    std::vector<double> x;
    std::vector<double> y;
  };
  std::string title;
  std::string x_name;
  std::string y_unit;  ///< "s", "m" and "J" get prefixes
  std::vector<Line> lines;
};

/// A figure with both axes logarithmic, its points marked and its lines named below. Values that are not positive and
/// finite are left out; empty where fewer than two points are left.
[[nodiscard]] std::string line_plot(const LinePlot& plot);

/// Figures side by side.
[[nodiscard]] std::string charts(const std::vector<std::string>& figures);

}  // namespace pd::report
