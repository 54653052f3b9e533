#include "drawing/svg_page.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>

#include "drawing/svg_text.hpp"
#include "support/refusal.hpp"

namespace pd::drawing {

namespace {

/// Nothing for a side that is not given, or 100 %.
std::optional<SvgLength> side(const pugi::xml_node& root, const char* name) {
  const pugi::xml_attribute attribute = root.attribute(name);
  if (!attribute || std::string_view(attribute.value()) == "auto") return std::nullopt;
  const std::string what = std::string("<svg> ") + name;
  const SvgLength length = parse_length(attribute.value(), what);
  if (length.unit == "%") {
    if (length.value == 100) return std::nullopt;
    query::refuse("unsupported", what + ": a percentage of nothing known; give a length, or leave it out", "");
  }
  if (length.value <= 0) query::refuse("bad_value", what + ": must be greater than 0", "");
  return length;
}

struct ViewBox {
  double x, y, width, height;
};

std::optional<ViewBox> view_box(const pugi::xml_node& root) {
  const pugi::xml_attribute attribute = root.attribute("viewBox");
  if (!attribute) return std::nullopt;
  SvgScanner scanner(attribute.value(), "<svg> viewBox");
  std::array<double, 4> n;
  scanner.skip_blanks();
  for (double& x : n) {
    x = scanner.number();
    scanner.skip_separator();
  }
  if (!scanner.done()) scanner.refuse("four numbers are expected: x y width height");
  if (n[2] <= 0 || n[3] <= 0) scanner.refuse("width and height must be greater than 0");
  return ViewBox{n[0], n[1], n[2], n[3]};
}

/// Share of the spare room before the drawing: xMid -> 0.5.
double share(std::string_view word, const std::string& text) {
  if (word == "Min") return 0;
  if (word == "Mid") return 0.5;
  if (word == "Max") return 1;
  query::refuse("bad_value", "<svg> preserveAspectRatio: \"" + text + "\" is no alignment", "");
}

PlaneMap fit(const ViewBox& box, double width, double height, const std::string& aspect) {
  double sx = width / box.width, sy = height / box.height;
  double ax = 0.5, ay = 0.5;
  const std::size_t blank = std::min(aspect.find(' '), aspect.size());
  const std::string align = aspect.substr(0, blank);
  if (align != "none") {
    const std::string fitting = blank < aspect.size() ? aspect.substr(blank + 1) : "meet";
    if (align.size() != 8 || align[0] != 'x' || align[4] != 'Y' || (fitting != "meet" && fitting != "slice")) {
      query::refuse("bad_value", "<svg> preserveAspectRatio: \"" + aspect + "\" is no alignment", "");
    }
    ax = share(std::string_view(align).substr(1, 3), aspect);
    ay = share(std::string_view(align).substr(5, 3), aspect);
    sx = sy = fitting == "meet" ? std::min(sx, sy) : std::max(sx, sy);
  }
  return {sx, 0, 0, sy, ax * (width - sx * box.width) - sx * box.x, ay * (height - sy * box.height) - sy * box.y};
}

}  // namespace

SvgPage read_page(const pugi::xml_node& root) {
  const auto width = side(root, "width"), height = side(root, "height");
  const auto box = view_box(root);
  if (!width && !height) return {{}, ""};
  std::string unit = width ? width->unit : height->unit;
  if (unit.empty()) unit = "px";
  const double pixels = pixels_of(unit);
  if (!box) return {{1 / pixels, 0, 0, 1 / pixels, 0, 0}, unit};
  const auto in_unit = [&](const SvgLength& l) {
    return l.unit == unit ? l.value : l.value * pixels_of(l.unit) / pixels;
  };
  // A side that is not given follows from the other one.
  const double w = width ? in_unit(*width) : in_unit(*height) * box->width / box->height;
  const double h = height ? in_unit(*height) : in_unit(*width) * box->height / box->width;
  const pugi::xml_attribute aspect = root.attribute("preserveAspectRatio");
  return {fit(*box, w, h, aspect ? aspect.value() : "xMidYMid meet"), unit};
}

}  // namespace pd::drawing
