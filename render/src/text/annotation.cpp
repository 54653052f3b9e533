#include "pd/render/annotation.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "text/canvas.hpp"

namespace pd::render {
namespace {

using detail::Align;
using detail::Canvas;
using detail::Point;
using detail::TextStyle;

/// Margins and sizes in units of 1 / 720 of the picture's height.
struct Layout {
  double unit;
  double width;
  double height;
  double margin;
};

void draw_caption(Canvas& canvas, const Annotation& annotation, const Layout& layout) {
  const double u = layout.unit;
  double y = layout.margin + 20 * u;
  if (!annotation.title.empty()) {
    canvas.text({layout.margin, y}, annotation.title, {.size = 27 * u, .weight = 650, .colour = palette::kInk});
    y += 26 * u;
  }
  if (!annotation.subtitle.empty()) {
    canvas.text({layout.margin, y}, annotation.subtitle, {.size = 16 * u, .weight = 450, .colour = palette::kInkSoft});
  }
}

/// @return height that the sparkline takes above the lower margin.
double draw_sparkline(Canvas& canvas, const Sparkline& sparkline, const Layout& layout) {
  if (sparkline.values.size() < 2) {
    return 0;
  }
  const double u = layout.unit;
  const double height = 34 * u;
  const double left = layout.margin;
  const double right = layout.width - layout.margin;
  const double base = layout.height - 0.62 * layout.margin;
  const double largest = *std::max_element(sparkline.values.begin(), sparkline.values.end());
  const double full = sparkline.full_scale > 0 ? sparkline.full_scale : std::max(largest, 1e-300);
  std::vector<Point> line;
  for (std::size_t i = 0; i < sparkline.values.size(); ++i) {
    const double x = left + (right - left) * static_cast<double>(i) / static_cast<double>(sparkline.values.size() - 1);
    const double value = std::isfinite(sparkline.values[i]) ? sparkline.values[i] : 0;
    line.push_back({x, base - height * std::clamp(value / full, 0.0, 1.0)});
  }
  const std::size_t now = std::min(sparkline.now, line.size() - 1);
  const std::array<Point, 2> axis = {{{left, base}, {right, base}}};
  canvas.stroke(axis, 1 * u, palette::kInkFaint, 0.6);
  canvas.stroke(line, 1.2 * u, sparkline.colour, 0.28);
  std::vector<Point> area(line.begin(), line.begin() + static_cast<std::ptrdiff_t>(now) + 1);
  canvas.stroke(area, 1.8 * u, sparkline.colour, 0.95);
  area.push_back({line[now].x, base});
  area.push_back({left, base});
  canvas.fill_polygon(area, sparkline.colour, 0.13);
  canvas.fill_circle(line[now], 3.4 * u, palette::kPaper, 0.95);
  canvas.fill_circle(line[now], 2.4 * u, sparkline.colour);
  const TextStyle quiet{.size = 12 * u, .weight = 450, .colour = palette::kInkSoft};
  canvas.text({left, base - height - 6 * u}, sparkline.meaning, quiet);
  if (!sparkline.full_scale_text.empty()) {
    const std::array<Point, 2> top = {{{left, base - height}, {right, base - height}}};
    canvas.stroke(top, 0.8 * u, palette::kInkFaint, 0.5, true);
    TextStyle scale = quiet;
    scale.align = Align::right;
    canvas.text({right, base - height - 6 * u}, sparkline.full_scale_text, scale);
  }
  return height + 26 * u;
}

void draw_headlines(Canvas& canvas, const Annotation& annotation, const Layout& layout, double base) {
  const double u = layout.unit;
  double right = layout.width - layout.margin;
  // The last stands at the right edge; each is as wide as its wider line.
  for (auto headline = annotation.headlines.rbegin(); headline != annotation.headlines.rend(); ++headline) {
    const TextStyle value{.size = 30 * u, .weight = 600, .colour = headline->colour, .align = Align::right};
    const TextStyle meaning{.size = 13.5 * u, .weight = 450, .colour = palette::kInkSoft, .align = Align::right};
    const double width =
        std::max(canvas.measure(headline->value, value).width, canvas.measure(headline->meaning, meaning).width);
    canvas.text({right, base - 20 * u}, headline->value, value);
    canvas.text({right, base}, headline->meaning, meaning);
    right -= width + 34 * u;
  }
}

void draw_legend(Canvas& canvas, const Annotation& annotation, const Layout& layout) {
  const double u = layout.unit;
  const TextStyle style{.size = 14.5 * u, .weight = 450, .colour = palette::kInk};
  double widest = 0;
  for (const LegendEntry& entry : annotation.legend) {
    widest = std::max(widest, canvas.measure(entry.text, style).width);
  }
  const double x = layout.width - layout.margin - widest - 24 * u;
  double y = layout.margin + 14 * u;
  for (const LegendEntry& entry : annotation.legend) {
    canvas.fill_rectangle(x, y - 11 * u, 13 * u, 13 * u, entry.colour, 1, 3 * u);
    canvas.text({x + 24 * u, y}, entry.text, style);
    y += 24 * u;
  }
}

}  // namespace

void annotate(Image& image, const Annotation& annotation) {
  Canvas canvas(image);
  const double unit = image.height() / 720.0;
  const Layout layout{unit, static_cast<double>(image.width()), static_cast<double>(image.height()), 36 * unit};
  draw_caption(canvas, annotation, layout);
  draw_legend(canvas, annotation, layout);
  const double taken = draw_sparkline(canvas, annotation.sparkline, layout);
  const double base = layout.height - (taken > 0 ? 0.62 : 1) * layout.margin - taken - (taken > 0 ? 8 * unit : 0);
  if (!annotation.status.empty()) {
    canvas.text({layout.margin, base}, annotation.status,
                {.size = 16 * unit, .weight = 500, .colour = palette::kInkSoft});
  }
  draw_headlines(canvas, annotation, layout, base);
}

}  // namespace pd::render
