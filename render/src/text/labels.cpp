#include "text/labels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include "pipeline/frame_setup.hpp"
#include "text/canvas.hpp"

namespace pd::render::detail {
namespace {

struct Rectangle {
  double x;
  double y;
  double width;
  double height;
  [[nodiscard]] bool overlaps(const Rectangle& other) const {
    return x < other.x + other.width && other.x < x + width && y < other.y + other.height && other.y < y + height;
  }
};

/// Places boxes one after the other, each moved down (then up) until it is clear of those before and inside the
/// picture.
class Placement {
 public:
  explicit Placement(Size picture, double margin) : picture_(picture), margin_(margin) {}

  Rectangle place(Rectangle wanted) {
    wanted.x = std::clamp(wanted.x, margin_, std::max(margin_, picture_.width - margin_ - wanted.width));
    wanted.y = std::clamp(wanted.y, margin_, std::max(margin_, picture_.height - margin_ - wanted.height));
    Rectangle best = wanted;
    for (int attempt = 0; attempt < 24; ++attempt) {
      const double step = 0.5 * (wanted.height + 4) * ((attempt + 1) / 2) * (attempt % 2 == 0 ? -1 : 1);
      best.y = std::clamp(wanted.y + step, margin_, std::max(margin_, picture_.height - margin_ - wanted.height));
      if (std::none_of(taken_.begin(), taken_.end(), [&](const Rectangle& other) { return other.overlaps(best); })) {
        break;
      }
    }
    taken_.push_back(best);
    return best;
  }

 private:
  Size picture_;
  double margin_;
  std::vector<Rectangle> taken_;
};

void draw_arrow_label(Canvas& canvas, Placement& placement, const Arrow& arrow, const Camera& camera, Size size) {
  const PicturePoint from = project(camera, size, arrow.from);
  const PicturePoint to = project(camera, size, arrow.to);
  if (arrow.label.empty() || from.distance <= 0 || to.distance <= 0) {
    return;
  }
  const double unit = size.height / 720.0;
  const std::size_t line_end = std::min(arrow.label.find('\n'), arrow.label.size());
  const std::string value = arrow.label.substr(0, line_end);
  const std::string bracket = line_end < arrow.label.size() ? arrow.label.substr(line_end + 1) : "";
  const TextStyle value_style{
      .size = 19 * unit, .weight = 650, .colour = palette::mix(arrow.colour, palette::kInk, 0.25f)};
  const TextStyle bracket_style{.size = 13.5 * unit, .weight = 450, .colour = palette::kInkSoft};
  const double width = std::max(canvas.measure(value, value_style).width,
                                bracket.empty() ? 0 : canvas.measure(bracket, bracket_style).width);
  const double pad = 9 * unit;
  const double height = (bracket.empty() ? 22 : 41) * unit + pad;
  // Beside the middle of the arrow, to the right of it, clear of its head.
  const double clearance = 26 * unit + 0.5 * std::abs(to.x - from.x);
  const double x = 0.5 * (from.x + to.x) + clearance;
  const double y = 0.5 * (from.y + to.y) - 0.5 * height;
  const Rectangle box = placement.place({x, y, width + 2 * pad, height});
  const std::array<Point, 2> leader = {
      {{0.5 * (from.x + to.x) + 6 * unit, 0.5 * (from.y + to.y)}, {box.x, box.y + 0.5 * height}}};
  canvas.stroke(leader, 1.2 * unit, palette::kInkSoft, 0.55);
  canvas.fill_rectangle(box.x, box.y, box.width, box.height, palette::kPaper, 0.86, 6 * unit);
  canvas.text({box.x + pad, box.y + 0.5 * pad + 18 * unit}, value, value_style);
  if (!bracket.empty()) {
    canvas.text({box.x + pad, box.y + 0.5 * pad + 37 * unit}, bracket, bracket_style);
  }
}

/// One grid step on the floor, in front of the scene, along the grid axis that lies more across the view.
void draw_scale_bar(Canvas& canvas, const Scene& scene, const Camera& camera, Size size) {
  if (!scene.ground.visible || !scene.ground.scale_bar) {
    return;
  }
  const Box focus = scene.focus.empty() ? bounds(scene) : scene.focus;
  if (focus.empty()) {
    return;
  }
  Vec3 x;
  Vec3 y;
  ground_axes(scene.up, x, y);
  const Vec3 up = scene.up.normalized();
  Vec3 backward = camera.eye - camera.target;
  backward -= backward.dot(up) * up;
  if (backward.norm() < 1e-9 * (camera.eye - camera.target).norm()) {
    return;  // straight from above: no front
  }
  backward.normalize();
  const bool along_x = std::abs(backward.dot(x)) < std::abs(backward.dot(y));
  const Vec3 along = along_x ? x : y;
  const Vec3 front = along_x ? Vec3(backward.dot(y) > 0 ? y : Vec3(-y)) : Vec3(backward.dot(x) > 0 ? x : Vec3(-x));
  const double step = grid_step(scene);
  const Vec3 half = 0.5 * (focus.upper - focus.lower);
  const double reach = half.cwiseAbs().dot(front.cwiseAbs());
  // On crossings of the grid, at least half a step in front of the bodies.
  const double forward = (std::floor((focus.centre().dot(front) + reach) / step + 0.5) + 1) * step;
  const double start = std::round(focus.centre().dot(along) / step - 0.5) * step;
  const Vec3 from = start * along + forward * front + scene.ground.height * up;
  const PicturePoint a = project(camera, size, from);
  const PicturePoint b = project(camera, size, from + step * along);
  const double unit = size.height / 720.0;
  const bool inside = a.distance > 0 && b.distance > 0 && std::min(a.x, b.x) > 0 && std::max(a.x, b.x) < size.width &&
                      std::max(a.y, b.y) < size.height - 20 * unit && std::min(a.y, b.y) > 0;
  if (!inside || std::hypot(b.x - a.x, b.y - a.y) < 12 * unit) {
    return;
  }
  const std::array<Point, 2> bar = {{{a.x, a.y}, {b.x, b.y}}};
  canvas.stroke(bar, 2.4 * unit, palette::kInkSoft, 0.85);
  for (const Vec3& end : {from, Vec3(from + step * along)}) {
    const PicturePoint p = project(camera, size, end - 0.09 * step * front);
    const PicturePoint q = project(camera, size, end + 0.09 * step * front);
    const std::array<Point, 2> tick = {{{p.x, p.y}, {q.x, q.y}}};
    canvas.stroke(tick, 2.4 * unit, palette::kInkSoft, 0.85);
  }
  const TextStyle style{
      .size = 13 * unit, .weight = 500, .colour = palette::kInkSoft, .align = Align::centre, .halo = 1.5 * unit};
  canvas.text({0.5 * (a.x + b.x), std::max(a.y, b.y) + 17 * unit}, length_text(step * scene.ground.metres_per_unit),
              style);
}

}  // namespace

std::string length_text(double metres) {
  struct Unit {
    double metres;
    const char* name;
  };
  constexpr std::array<Unit, 6> kUnits = {
      {{1e3, "km"}, {1, "m"}, {1e-2, "cm"}, {1e-3, "mm"}, {1e-6, "\u00b5m"}, {1e-9, "nm"}}};
  std::array<char, 48> text{};
  for (const Unit& unit : kUnits) {
    if (metres >= 0.9999 * unit.metres && metres < 1e6) {
      std::snprintf(text.data(), text.size(), "%.4g %s", metres / unit.metres, unit.name);
      return text.data();
    }
  }
  std::snprintf(text.data(), text.size(), "%.3g m", metres);
  return text.data();
}

void draw_labels(Image& image, const Scene& scene, const Camera& camera) {
  Canvas canvas(image);
  const Size size = image.size();
  const double unit = size.height / 720.0;
  draw_scale_bar(canvas, scene, camera, size);
  Placement placement(size, 10 * unit);
  for (const Arrow& arrow : scene.arrows) {
    draw_arrow_label(canvas, placement, arrow, camera, size);
  }
  for (const Label& label : scene.labels) {
    const PicturePoint at = project(camera, size, label.at);
    if (at.distance > 0) {
      const TextStyle style{.size = 15 * unit, .weight = 550, .colour = label.colour, .halo = 2.5 * unit};
      const TextExtent extent = canvas.measure(label.text, style);
      const Rectangle box = placement.place({at.x + 8 * unit, at.y - 0.5 * (extent.ascent + extent.descent),
                                             extent.width, extent.ascent + extent.descent});
      canvas.text({box.x, box.y + extent.ascent}, label.text, style);
    }
  }
}

}  // namespace pd::render::detail
