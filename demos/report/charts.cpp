#include "report/charts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "report/html_text.hpp"

namespace pd::report {

namespace {

constexpr double kLeft = 58;
constexpr double kWidth = 332;
constexpr double kTop = 10;
constexpr double kHeight = 190;
constexpr int kColours = 4;
constexpr int kDashes = 3;

/// Percent of the full length.
double share_of(const BarChart& chart, double value, double least, double most) {
  if (!std::isfinite(value) || value <= 0 || most <= 0) return 0;
  if (!chart.logarithmic) return 100 * value / most;
  const double from = std::floor(std::log10(least) - 0.1);
  return 100 * (std::log10(value) - from) / (std::log10(most) - from);
}

struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = 0;
  void add(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
  /// Some room where all values are one.
  void widen() {
    if (high < 1.2 * low) {
      low /= 1.5;
      high *= 1.5;
    }
  }
  /// Where a value stands, in [0, 1].
  [[nodiscard]] double at(double value) const {
    return (std::log10(value) - std::log10(low)) / (std::log10(high) - std::log10(low));
  }
};

/// Powers of ten within; powers of two where these are fewer than two; the ends where those are, too.
std::vector<double> ticks(const Range& range) {
  for (const double base : {10.0, 2.0}) {
    std::vector<double> result;
    const auto from = static_cast<int>(std::ceil(std::log(range.low) / std::log(base) - 1e-9));
    const auto to = static_cast<int>(std::floor(std::log(range.high) / std::log(base) + 1e-9));
    const int step = std::max(1, (to - from + 5) / 6);
    for (int power = from; power <= to; power += step) result.push_back(std::pow(base, power));
    if (result.size() >= 2) return result;
  }
  return {range.low, range.high};
}

/// "100 \u00b5s", "1000", "1e6", "256".
std::string tick_text(double value, std::string_view unit) {
  if (!unit.empty()) return quantity(value, unit);
  const double power = std::round(std::log10(value));
  const bool of_ten = std::abs(value / std::pow(10, power) - 1) < 1e-9;
  if (of_ten && (power > 3 || power < -3)) return fmt::format("1e{:.0f}", power);
  return value == std::floor(value) && value < 1e5 ? fmt::format("{:.0f}", value) : short_number(value);
}

bool is_drawn(double x, double y) { return std::isfinite(x) && std::isfinite(y) && x > 0 && y > 0; }

struct Axes {
  Range x;
  Range y;
  [[nodiscard]] double left(double value) const { return kLeft + kWidth * x.at(value); }
  [[nodiscard]] double top(double value) const { return kTop + kHeight * (1 - y.at(value)); }
};

std::string style_of(std::size_t line) { return fmt::format("s{} d{}", line % kColours, line / kColours % kDashes); }

void draw_axes(const LinePlot& plot, const Axes& axes, std::string& text) {
  const auto out = std::back_inserter(text);
  for (const double value : ticks(axes.y)) {
    fmt::format_to(out,
                   "<line class=\"rule\" x1=\"{0}\" x2=\"{1}\" y1=\"{2:.1f}\" y2=\"{2:.1f}\"/><text x=\"{3}\" "
                   "y=\"{4:.1f}\" text-anchor=\"end\">{5}</text>\n",
                   kLeft, kLeft + kWidth, axes.top(value), kLeft - 5, axes.top(value) + 4,
                   escaped(tick_text(value, plot.y_unit)));
  }
  for (const double value : ticks(axes.x)) {
    const double left = axes.left(value);
    fmt::format_to(out,
                   "<line class=\"rule\" x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1}\" y2=\"{2}\"/><text x=\"{0:.1f}\" "
                   "y=\"{3}\" text-anchor=\"{4}\">{5}</text>\n",
                   left, kTop, kTop + kHeight, kTop + kHeight + 15, left > kLeft + kWidth - 10 ? "end" : "middle",
                   escaped(tick_text(value, "")));
  }
  fmt::format_to(out, "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n", kLeft + kWidth / 2,
                 kTop + kHeight + 31, escaped(plot.x_name));
}

void draw_line(const LinePlot::Line& line, const std::string& style, const LinePlot& plot, const Axes& axes,
               std::string& text) {
  const auto out = std::back_inserter(text);
  std::string path;
  std::string marks;
  for (std::size_t i = 0; i < line.x.size(); ++i) {
    if (!is_drawn(line.x[i], line.y[i])) continue;
    const double left = axes.left(line.x[i]);
    const double top = axes.top(line.y[i]);
    path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : "L", left, top);
    marks += fmt::format(
        "<circle class=\"{}\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"2.6\"><title>{}: {} at {} {}</title></circle>\n", style,
        left, top, escaped(line.name), escaped(quantity(line.y[i], plot.y_unit)), escaped(plot.x_name),
        short_number(line.x[i]));
  }
  fmt::format_to(out, "<path class=\"{}\" d=\"{}\"/>\n{}", style, path, marks);
}

}  // namespace

std::string bar_chart(const BarChart& chart) {
  double least = std::numeric_limits<double>::infinity();
  double most = 0;
  for (const BarChart::Bar& bar : chart.bars) {
    if (!std::isfinite(bar.value) || bar.value <= 0) continue;
    least = std::min(least, bar.value);
    most = std::max(most, bar.value);
  }
  std::string text = fmt::format("<figure class=\"bars\"><figcaption>{}</figcaption>\n", escaped(chart.title));
  if (!chart.text.empty()) text += fmt::format("<p class=\"quiet\">{}</p>\n", escaped(chart.text));
  text += "<ol>\n";
  for (const BarChart::Bar& bar : chart.bars) {
    text +=
        fmt::format("<li{}><span>{}</span><span class=\"track\"><i style=\"width:{:.1f}%\"></i></span><b>{}</b></li>\n",
                    bar.ours ? " class=\"ours\"" : "", escaped(bar.name), share_of(chart, bar.value, least, most),
                    escaped(bar.shown));
  }
  return text + "</ol></figure>\n";
}

std::string line_plot(const LinePlot& plot) {
  Axes axes;
  int points = 0;
  for (const LinePlot::Line& line : plot.lines) {
    for (std::size_t i = 0; i < line.x.size(); ++i) {
      if (!is_drawn(line.x[i], line.y[i])) continue;
      axes.x.add(line.x[i]);
      axes.y.add(line.y[i]);
      ++points;
    }
  }
  if (points < 2) return {};
  axes.x.widen();
  axes.y.widen();
  std::string text = fmt::format(
      "<figure><figcaption>{0}</figcaption>\n<svg class=\"chart plot\" viewBox=\"0 0 400 246\" role=\"img\" "
      "aria-label=\"{0} against {1}, both axes logarithmic\">\n",
      escaped(plot.title), escaped(plot.x_name));
  draw_axes(plot, axes, text);
  for (std::size_t i = 0; i < plot.lines.size(); ++i) draw_line(plot.lines[i], style_of(i), plot, axes, text);
  text += "</svg>\n<ul class=\"legend\">\n";
  for (std::size_t i = 0; i < plot.lines.size(); ++i) {
    text += fmt::format(
        "<li><svg class=\"plot\" viewBox=\"0 0 24 8\" aria-hidden=\"true\"><path class=\"{}\" d=\"M0 4L24 4\"/></svg>{}"
        "</li>\n",
        style_of(i), escaped(plot.lines[i].name));
  }
  return text + "</ul></figure>\n";
}

std::string charts(const std::vector<std::string>& figures) {
  std::string text = "<div class=\"charts\">\n";
  for (const std::string& figure : figures) text += figure;
  return text + "</div>\n";
}

}  // namespace pd::report
