#include "pd/render/plane_figure.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

#include "text/canvas.hpp"

namespace pd::render {
namespace {

using detail::Align;
using detail::Canvas;
using detail::Point;

/// From the figure's plane to pixels.
class View {
 public:
  View(const PlaneFigure& figure, Size size) : up_(figure.y_down ? 1 : -1) {
    Point2 low = {std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
    Point2 high = {-low[0], -low[1]};
    const auto add = [&](const Point2& p) {
      for (std::size_t k = 0; k < 2; ++k) {
        low[k] = std::min(low[k], p[k]);
        high[k] = std::max(high[k], p[k]);
      }
    };
    for (const PlaneRegion& region : figure.regions) {
      for (const auto& ring : region.rings) std::for_each(ring.begin(), ring.end(), add);
    }
    for (const PlaneLine& line : figure.lines) std::for_each(line.points.begin(), line.points.end(), add);
    for (const PlaneDot& dot : figure.dots) add(dot.at);
    for (const PlaneArrow& arrow : figure.arrows) {
      add(arrow.from);
      add(arrow.to);
    }
    const double u = size.height / 720.0;
    const double sides = 48 * u, bottom = 76 * u;  // the scale bar stands below
    const double top = (48 + 24 * figure.legend_lines) * u;
    const double width = std::max(high[0] - low[0], 1e-300), height = std::max(high[1] - low[1], 1e-300);
    scale_ = std::min((size.width - 2 * sides) / width, (size.height - top - bottom) / height);
    middle_ = {0.5 * low[0] + 0.5 * high[0], 0.5 * low[1] + 0.5 * high[1]};
    centre_ = {0.5 * size.width, top + 0.5 * (size.height - top - bottom)};
  }

  [[nodiscard]] Point pixel(const Point2& p) const {
    return {centre_.x + scale_ * (p[0] - middle_[0]), centre_.y + up_ * scale_ * (p[1] - middle_[1])};
  }
  [[nodiscard]] Point2 plane(const Point& p) const {
    return {middle_[0] + (p.x - centre_.x) / scale_, middle_[1] + up_ * (p.y - centre_.y) / scale_};
  }
  [[nodiscard]] double scale() const { return scale_; }
  [[nodiscard]] std::vector<Point> pixels(const std::vector<Point2>& points) const {
    std::vector<Point> r;
    for (const Point2& p : points) r.push_back(pixel(p));
    return r;
  }

 private:
  double up_, scale_ = 1;
  Point2 middle_ = {};
  Point centre_ = {};
};

/// The least 1, 2 or 5 times a power of ten that is at least x.
double round_length(double x) {
  const double power = std::pow(10, std::floor(std::log10(x)));
  for (const double step : {1.0, 2.0, 5.0}) {
    if (step * power >= x) return step * power;
  }
  return 10 * power;
}

void draw_backdrop(Image& image) {
  for (int y = 0; y < image.height(); ++y) {
    const float t = static_cast<float>(y) / static_cast<float>(std::max(1, image.height() - 1));
    const Colour c = palette::mix(palette::mix(palette::kBackdropTop, palette::kPaper, 0.55f),
                                  palette::mix(palette::kBackdropBottom, palette::kPaper, 0.55f), t);
    const std::array<float, 3> parts = {c.r, c.g, c.b};
    for (int x = 0; x < image.width(); ++x) {
      for (std::size_t k = 0; k < 3; ++k) {
        image.pixel(x, y)[k] = static_cast<std::uint8_t>(std::lround(255 * parts[k]));
      }
    }
  }
}

void draw_grid(Canvas& canvas, const View& view, Size size, const std::string& unit) {
  const double u = size.height / 720.0;
  const double step = round_length(56 * u / view.scale());
  const Point2 a = view.plane({0, 0}),
               b = view.plane({static_cast<double>(size.width), static_cast<double>(size.height)});
  for (std::size_t k = 0; k < 2; ++k) {
    const double low = std::min(a[k], b[k]), high = std::max(a[k], b[k]);
    const int lines = static_cast<int>(std::min(1000.0, (high - low) / step));
    for (int i = 0; i <= lines; ++i) {
      Point2 from = a, to = b;
      from[k] = to[k] = (std::ceil(low / step) + i) * step;
      const std::array<Point, 2> line = {view.pixel(from), view.pixel(to)};
      canvas.stroke(line, 1 * u, palette::kInkFaint, 0.16);
    }
  }
  const double bar = round_length(0.09 * size.width / view.scale());
  const double y = size.height - 30 * u, left = 36 * u, right = left + bar * view.scale();
  const std::array<Point, 4> bracket = {{{left, y - 5 * u}, {left, y}, {right, y}, {right, y - 5 * u}}};
  canvas.stroke(bracket, 1.6 * u, palette::kInkSoft);
  std::array<char, 32> digits;
  std::snprintf(digits.data(), digits.size(), "%.6g", bar);
  canvas.text({right + 8 * u, y + 2 * u}, std::string(digits.data()) + (unit.empty() ? "" : " " + unit),
              {.size = 14 * u, .weight = 450, .colour = palette::kInkSoft});
}

void draw_region(Canvas& canvas, const PlaneRegion& region, const View& view, double u) {
  std::vector<std::vector<Point>> rings;
  for (const auto& ring : region.rings) rings.push_back(view.pixels(ring));
  canvas.fill_rings(rings, region.colour, region.opacity);
  if (region.outline_pixels <= 0) return;
  const Colour darker = palette::mix(region.colour, palette::kInk, 0.45f);
  for (std::vector<Point>& ring : rings) {
    ring.push_back(ring.front());
    canvas.stroke(ring, region.outline_pixels * u, darker, std::max(0.6, region.opacity), region.dashed);
  }
}

void draw_arrow(Canvas& canvas, const PlaneArrow& arrow, const View& view, double u) {
  const Point from = view.pixel(arrow.from), to = view.pixel(arrow.to);
  const double dx = to.x - from.x, dy = to.y - from.y, length = std::hypot(dx, dy);
  if (!(length > 0)) return;
  const double ux = dx / length, uy = dy / length;
  const double head = std::min(17 * u, 0.6 * length), half = 0.48 * head;
  const auto at = [&](double along, double across) {
    return Point{to.x - along * ux - across * uy, to.y - along * uy + across * ux};
  };
  const std::array<Point, 2> shaft = {from, at(0.8 * head, 0)};
  const std::array<Point, 4> rim = {at(0, 0), at(head, half), at(head, -half), at(0, 0)};
  canvas.stroke(shaft, 8.5 * u, palette::kPaper, 0.85);
  canvas.stroke(rim, 4.5 * u, palette::kPaper, 0.85);
  canvas.stroke(shaft, 4.5 * u, arrow.colour);
  canvas.fill_polygon(rim, arrow.colour);
  if (arrow.label.empty()) return;
  // On the side of the arrow that has more room below it: to the right of what points up or down.
  const double side = ux >= 0 ? -1 : 1;
  const Point middle = {0.5 * (from.x + to.x) - side * uy * 18 * u, 0.5 * (from.y + to.y) + side * ux * 18 * u};
  const bool steep = std::abs(uy) > 0.6;
  canvas.text({middle.x, middle.y + 6 * u}, arrow.label,
              {.size = 19 * u,
               .weight = 650,
               .colour = palette::mix(arrow.colour, palette::kInk, 0.25f),
               .align = !steep ? Align::centre : (-side * uy > 0 ? Align::left : Align::right),
               .halo = 3 * u});
}

}  // namespace

Image draw_plane_figure(const PlaneFigure& figure, Size size) {
  Image image(size, palette::kPaper);
  draw_backdrop(image);
  Canvas canvas(image);
  const View view(figure, size);
  const double u = size.height / 720.0;
  draw_grid(canvas, view, size, figure.unit);
  for (const PlaneRegion& region : figure.regions) draw_region(canvas, region, view, u);
  for (const PlaneLine& line : figure.lines) {
    canvas.stroke(view.pixels(line.points), line.width_pixels * u, line.colour, line.opacity, line.dashed);
  }
  for (const PlaneDot& dot : figure.dots) {
    const Point at = view.pixel(dot.at);
    canvas.fill_circle(at, (dot.radius_pixels + 1.5) * u, palette::kPaper, 0.9);
    canvas.fill_circle(at, dot.radius_pixels * u, dot.colour);
  }
  for (const PlaneArrow& arrow : figure.arrows) draw_arrow(canvas, arrow, view, u);
  for (const PlaneDot& dot : figure.dots) {
    const Point at = view.pixel(dot.at);
    canvas.text({at.x + (dot.radius_pixels + 7) * u, at.y + 5 * u}, dot.label,
                {.size = 15 * u, .weight = 550, .colour = palette::kInk, .halo = 3 * u});
  }
  return image;
}

}  // namespace pd::render
