/// @file
/// Line charts as standalone pictures: linear, semi-logarithmic, log-log with fitted exponents.
#pragma once

#include <string>
#include <vector>

#include "pd/render/image.hpp"
#include "pd/render/palette.hpp"

namespace pd::render {

struct Series {
  std::string name;
  std::vector<double> x;
  std::vector<double> y;  ///< same count; points that are not finite (or not positive on a log axis) are left out
  bool markers = false;
  bool dashed = false;
  bool fit_exponent = false;  ///< log-log: adds "~ x^1.02" (least squares over the drawn points) to the name
  int colour = -1;            ///< palette::series index; -1: by position
};

enum class Scale { linear, logarithmic };

struct Chart {
  std::string title = {};
  std::string subtitle = {};
  std::string x_label = {};
  std::string y_label = {};
  Scale x_scale = Scale::linear;
  Scale y_scale = Scale::linear;
  bool y_from_zero = true;  ///< linear axes start at 0
  std::vector<Series> series = {};
};

/// The series' names stand at their line ends where there is room for them, else in a legend.
[[nodiscard]] Image draw_chart(const Chart& chart, Size size);

/// Least-squares slope of log y over log x (positive finite points only); NaN with fewer than two distinct x.
[[nodiscard]] double fitted_exponent(const Series& series);

}  // namespace pd::render
