#include "text/canvas.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <numbers>

namespace pd::render::detail {

static_assert(std::endian::native == std::endian::little,
              "Canvas exchanges red and blue for a little-endian Cairo pixel");

Canvas::Canvas(Image& image)
    : surface_(cairo_image_surface_create_for_data(image.bytes().data(), CAIRO_FORMAT_RGB24, image.width(),
                                                   image.height(), 4 * image.width())),
      cairo_(cairo_create(surface_)),
      layout_(pango_cairo_create_layout(cairo_)),
      font_(pango_font_description_from_string("Inter, DejaVu Sans")) {
  // No hinting and no subpixel order: the same letters on every machine, at every size.
  cairo_font_options_t* options = cairo_font_options_create();
  cairo_font_options_set_antialias(options, CAIRO_ANTIALIAS_GRAY);
  cairo_font_options_set_hint_style(options, CAIRO_HINT_STYLE_NONE);
  cairo_font_options_set_hint_metrics(options, CAIRO_HINT_METRICS_OFF);
  pango_cairo_context_set_font_options(pango_layout_get_context(layout_), options);
  pango_cairo_context_set_resolution(pango_layout_get_context(layout_), 72);
  cairo_font_options_destroy(options);
  PangoAttrList* attributes = pango_attr_list_new();
  pango_attr_list_insert(attributes, pango_attr_font_features_new("tnum=1, calt=1"));
  pango_layout_set_attributes(layout_, attributes);
  pango_attr_list_unref(attributes);
  cairo_set_line_join(cairo_, CAIRO_LINE_JOIN_ROUND);
  cairo_set_line_cap(cairo_, CAIRO_LINE_CAP_ROUND);
}

Canvas::~Canvas() {
  pango_font_description_free(font_);
  g_object_unref(layout_);
  cairo_destroy(cairo_);
  cairo_surface_finish(surface_);
  cairo_surface_destroy(surface_);
}

void Canvas::set_colour(Colour colour, double opacity) {
  cairo_set_source_rgba(cairo_, colour.b, colour.g, colour.r, opacity);
}

PangoLayout* Canvas::layout(const std::string& words, const TextStyle& style) {
  pango_font_description_set_absolute_size(font_, style.size * PANGO_SCALE);
  pango_font_description_set_weight(font_, static_cast<PangoWeight>(style.weight));
  pango_layout_set_font_description(layout_, font_);
  pango_layout_set_text(layout_, words.c_str(), static_cast<int>(words.size()));
  return layout_;
}

TextExtent Canvas::measure(const std::string& words, const TextStyle& style) {
  PangoRectangle logical;
  pango_layout_get_extents(layout(words, style), nullptr, &logical);
  const double ascent = static_cast<double>(pango_layout_get_baseline(layout_)) / PANGO_SCALE;
  return {static_cast<double>(logical.width) / PANGO_SCALE, ascent,
          static_cast<double>(logical.height) / PANGO_SCALE - ascent};
}

double Canvas::text(Point at, const std::string& words, const TextStyle& style) {
  const TextExtent extent = measure(words, style);
  const double shift = style.align == Align::left ? 0 : style.align == Align::centre ? 0.5 : 1;
  cairo_move_to(cairo_, at.x - shift * extent.width, at.y - extent.ascent);
  if (style.halo > 0) {
    pango_cairo_layout_path(cairo_, layout_);
    set_colour(palette::kPaper, 0.85 * style.opacity);
    cairo_set_line_width(cairo_, 2 * style.halo);
    cairo_stroke(cairo_);
    cairo_move_to(cairo_, at.x - shift * extent.width, at.y - extent.ascent);
  }
  set_colour(style.colour, style.opacity);
  pango_cairo_show_layout(cairo_, layout_);
  cairo_new_path(cairo_);
  return extent.width;
}

void Canvas::vertical_text(Point middle, const std::string& words, const TextStyle& style) {
  cairo_save(cairo_);
  cairo_translate(cairo_, middle.x, middle.y);
  cairo_rotate(cairo_, -std::numbers::pi / 2);
  TextStyle centred = style;
  centred.align = Align::centre;
  text({0, 0}, words, centred);
  cairo_restore(cairo_);
}

void Canvas::fill_rectangle(double x, double y, double width, double height, Colour colour, double opacity,
                            double corner) {
  const double r = std::min({corner, 0.5 * width, 0.5 * height});
  if (r > 0) {
    constexpr double kQuarter = std::numbers::pi / 2;
    cairo_new_sub_path(cairo_);
    cairo_arc(cairo_, x + width - r, y + r, r, -kQuarter, 0);
    cairo_arc(cairo_, x + width - r, y + height - r, r, 0, kQuarter);
    cairo_arc(cairo_, x + r, y + height - r, r, kQuarter, 2 * kQuarter);
    cairo_arc(cairo_, x + r, y + r, r, 2 * kQuarter, 3 * kQuarter);
    cairo_close_path(cairo_);
  } else {
    cairo_rectangle(cairo_, x, y, width, height);
  }
  set_colour(colour, opacity);
  cairo_fill(cairo_);
}

void Canvas::fill_polygon(std::span<const Point> loop, Colour colour, double opacity) {
  for (const Point& p : loop) {
    cairo_line_to(cairo_, p.x, p.y);
  }
  cairo_close_path(cairo_);
  set_colour(colour, opacity);
  cairo_fill(cairo_);
}

void Canvas::fill_rings(std::span<const std::vector<Point>> rings, Colour colour, double opacity) {
  for (const std::vector<Point>& ring : rings) {
    cairo_new_sub_path(cairo_);
    for (const Point& p : ring) cairo_line_to(cairo_, p.x, p.y);
    cairo_close_path(cairo_);
  }
  cairo_set_fill_rule(cairo_, CAIRO_FILL_RULE_EVEN_ODD);
  set_colour(colour, opacity);
  cairo_fill(cairo_);
  cairo_set_fill_rule(cairo_, CAIRO_FILL_RULE_WINDING);
}

void Canvas::stroke(std::span<const Point> line, double width, Colour colour, double opacity, bool dashed) {
  for (const Point& p : line) {
    cairo_line_to(cairo_, p.x, p.y);
  }
  const std::array<double, 2> dashes = {3.2 * width, 2.6 * width};
  cairo_set_dash(cairo_, dashes.data(), dashed ? 2 : 0, 0);
  cairo_set_line_width(cairo_, width);
  set_colour(colour, opacity);
  cairo_stroke(cairo_);
}

void Canvas::fill_circle(Point centre, double radius, Colour colour, double opacity) {
  cairo_new_sub_path(cairo_);
  cairo_arc(cairo_, centre.x, centre.y, radius, 0, 2 * std::numbers::pi);
  set_colour(colour, opacity);
  cairo_fill(cairo_);
}

}  // namespace pd::render::detail
