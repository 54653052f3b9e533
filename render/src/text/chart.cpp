#include "pd/render/chart.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>

#include "text/axis.hpp"
#include "text/canvas.hpp"

namespace pd::render {
namespace {

using detail::Align;
using detail::Axis;
using detail::Canvas;
using detail::Point;
using detail::TextStyle;

bool drawable(double value, Scale scale) { return std::isfinite(value) && (scale == Scale::linear || value > 0); }

/// The plotting rectangle; y down.
struct Plot {
  double left;
  double right;
  double top;
  double bottom;
  Axis x;
  Axis y;

  [[nodiscard]] Point place(double vx, double vy) const {
    return {left + (right - left) * x.place(vx), bottom - (bottom - top) * y.place(vy)};
  }
};

struct Range {
  double lower = std::numeric_limits<double>::infinity();
  double upper = -std::numeric_limits<double>::infinity();
  void include(double value) {
    lower = std::min(lower, value);
    upper = std::max(upper, value);
  }
};

std::string series_text(const Series& series) {
  if (!series.fit_exponent) {
    return series.name;
  }
  const double exponent = fitted_exponent(series);
  if (!std::isfinite(exponent)) {
    return series.name;
  }
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "  \u223c x^%.2f", exponent);
  return series.name + text.data();
}

void draw_axes(Canvas& canvas, const Plot& plot, const Chart& chart, double u) {
  const TextStyle quiet{.size = 14 * u, .weight = 450, .colour = palette::kInkSoft};
  for (const detail::Tick& tick : plot.y.ticks) {
    const double y = plot.place(plot.x.lower, tick.value).y;
    const std::array<Point, 2> rule = {{{plot.left, y}, {plot.right, y}}};
    canvas.stroke(rule, (tick.text.empty() ? 0.5 : 1) * u, palette::kRule, tick.text.empty() ? 0.6 : 1);
    TextStyle style = quiet;
    style.align = Align::right;
    canvas.text({plot.left - 10 * u, y + 5 * u}, tick.text, style);
  }
  for (const detail::Tick& tick : plot.x.ticks) {
    const double x = plot.place(tick.value, plot.y.lower).x;
    const std::array<Point, 2> mark = {{{x, plot.bottom}, {x, plot.bottom + (tick.text.empty() ? 3 : 6) * u}}};
    canvas.stroke(mark, 1 * u, palette::kInkFaint);
    TextStyle style = quiet;
    style.align = Align::centre;
    canvas.text({x, plot.bottom + 23 * u}, tick.text, style);
  }
  const std::array<Point, 2> base = {{{plot.left, plot.bottom}, {plot.right, plot.bottom}}};
  canvas.stroke(base, 1.2 * u, palette::kInkFaint);
  const TextStyle name{.size = 14.5 * u, .weight = 500, .colour = palette::kInkSoft, .align = Align::centre};
  canvas.text({0.5 * (plot.left + plot.right), plot.bottom + 48 * u}, chart.x_label, name);
  TextStyle above = name;
  above.align = Align::left;
  canvas.text({plot.left, plot.top - 16 * u}, chart.y_label, above);
}

/// @return where the drawn line ends, if anything was drawn.
std::optional<Point> draw_series(Canvas& canvas, const Plot& plot, const Chart& chart, const Series& series,
                                 Colour colour, double u) {
  std::vector<Point> line;
  std::optional<Point> end;
  const auto flush = [&] {
    if (line.size() >= 2) {
      canvas.stroke(line, 2.4 * u, colour, 1, series.dashed);
    }
    line.clear();
  };
  for (std::size_t i = 0; i < std::min(series.x.size(), series.y.size()); ++i) {
    if (!drawable(series.x[i], chart.x_scale) || !drawable(series.y[i], chart.y_scale)) {
      flush();  // a gap in the figures is a gap in the line
      continue;
    }
    end = plot.place(series.x[i], series.y[i]);
    line.push_back(*end);
    if (series.markers) {
      canvas.fill_circle(*end, 4.6 * u, palette::kPaper);
      canvas.fill_circle(*end, 3.6 * u, colour);
    }
  }
  flush();
  return end;
}

}  // namespace

double fitted_exponent(const Series& series) {
  double count = 0;
  double sum_x = 0;
  double sum_y = 0;
  double sum_xx = 0;
  double sum_xy = 0;
  for (std::size_t i = 0; i < std::min(series.x.size(), series.y.size()); ++i) {
    if (drawable(series.x[i], Scale::logarithmic) && drawable(series.y[i], Scale::logarithmic)) {
      const double x = std::log(series.x[i]);
      const double y = std::log(series.y[i]);
      count += 1;
      sum_x += x;
      sum_y += y;
      sum_xx += x * x;
      sum_xy += x * y;
    }
  }
  const double spread = count * sum_xx - sum_x * sum_x;
  return count >= 2 && spread > 1e-12 * std::max(1.0, count * sum_xx) ? (count * sum_xy - sum_x * sum_y) / spread
                                                                      : std::numeric_limits<double>::quiet_NaN();
}

namespace {

/// What of the series can be drawn; a decade where nothing can.
void ranges_of(const Chart& chart, Range& x_range, Range& y_range) {
  for (const Series& series : chart.series) {
    for (std::size_t i = 0; i < std::min(series.x.size(), series.y.size()); ++i) {
      if (drawable(series.x[i], chart.x_scale) && drawable(series.y[i], chart.y_scale)) {
        x_range.include(series.x[i]);
        y_range.include(series.y[i]);
      }
    }
  }
  if (!(x_range.lower <= x_range.upper)) {
    x_range = {1, 10};
    y_range = {1, 10};
  }
}

/// In units of u, as every length below: a 720th of the picture's height.
constexpr double kMargin = 44;

TextStyle name_style(double u) { return {.size = 15 * u, .weight = 600}; }

/// The axes with room for their figures on the left and for the names at the lines' ends on the right.
Plot lay_out(Canvas& canvas, const Chart& chart, Size size, double u) {
  Range x_range;
  Range y_range;
  ranges_of(chart, x_range, y_range);
  double names = 0;
  for (const Series& series : chart.series) {
    names = std::max(names, canvas.measure(series_text(series), name_style(u)).width);
  }
  Axis y_axis = detail::make_axis(chart.y_scale, y_range.lower, y_range.upper, chart.y_from_zero, 6);
  double figures = 0;
  for (const detail::Tick& tick : y_axis.ticks) {
    figures = std::max(figures, canvas.measure(tick.text, {.size = 14 * u, .weight = 450}).width);
  }
  Axis x_axis = detail::make_axis(chart.x_scale, x_range.lower, x_range.upper, false, 8);
  if (chart.x_scale == Scale::linear) {
    x_axis.lower = std::min(x_range.lower, x_axis.ticks.empty() ? x_range.lower : x_axis.ticks.front().value);
  }
  return {kMargin * u + figures + 12 * u,
          size.width - kMargin * u - std::min(names + 16 * u, 0.35 * size.width),
          150 * u,
          size.height - 84 * u,
          std::move(x_axis),
          std::move(y_axis)};
}

/// A series' name, at the end of its line.
struct Name {
  double y;
  Point end;
  std::string text;
  Colour colour;
};

/// Names keep their order and are pushed apart to a line's height, down first and back up from the lower end.
void draw_names(Canvas& canvas, const Plot& plot, std::vector<Name>& ends, double u) {
  std::stable_sort(ends.begin(), ends.end(), [](const Name& a, const Name& b) { return a.y < b.y; });
  const double line = 21 * u;
  for (std::size_t i = 1; i < ends.size(); ++i) {
    ends[i].y = std::max(ends[i].y, ends[i - 1].y + line);
  }
  double limit = plot.bottom;
  for (auto name = ends.rbegin(); name != ends.rend(); ++name) {
    name->y = std::min(name->y, limit);
    limit = name->y - line;
  }
  for (const Name& name : ends) {
    TextStyle style = name_style(u);
    style.colour = name.colour;
    const std::array<Point, 2> leader = {{{name.end.x + 6 * u, name.end.y}, {plot.right + 12 * u, name.y}}};
    canvas.stroke(leader, 1 * u, name.colour, 0.4);
    canvas.text({plot.right + 16 * u, name.y + 5 * u}, name.text, style);
  }
}

}  // namespace

Image draw_chart(const Chart& chart, Size size) {
  Image image(size, palette::kPaper);
  Canvas canvas(image);
  const double u = size.height / 720.0;
  const Plot plot = lay_out(canvas, chart, size, u);
  canvas.text({kMargin * u, 58 * u}, chart.title, {.size = 27 * u, .weight = 650});
  canvas.text({kMargin * u, 86 * u}, chart.subtitle, {.size = 16 * u, .weight = 450, .colour = palette::kInkSoft});
  draw_axes(canvas, plot, chart, u);
  std::vector<Name> ends;
  for (std::size_t i = 0; i < chart.series.size(); ++i) {
    const Series& series = chart.series[i];
    const Colour colour = palette::series(series.colour >= 0 ? static_cast<std::size_t>(series.colour) : i);
    if (const auto end = draw_series(canvas, plot, chart, series, colour, u)) {
      ends.push_back({end->y, *end, series_text(series), colour});
    }
  }
  draw_names(canvas, plot, ends, u);
  return image;
}

}  // namespace pd::render
