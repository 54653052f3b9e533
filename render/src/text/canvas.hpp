/// @file
/// Words, lines and boxes on a picture, through Cairo and Pango.
#pragma once

#include <cairo.h>
#include <pango/pangocairo.h>

#include <span>
#include <string>
#include <vector>

#include "pd/render/image.hpp"

namespace pd::render::detail {

enum class Align { left, centre, right };

struct TextStyle {
  double size = 16;  ///< of the letters' em, pixels
  int weight = 400;  ///< 400 plain, 500 medium, 600 semi-bold, 700 bold
  Colour colour = palette::kInk;
  double opacity = 1;
  Align align = Align::left;
  double halo = 0;  ///< width of a paper-coloured outline, pixels
};

struct Point {
  double x;
  double y;
};

struct TextExtent {
  double width;
  double ascent;
  double descent;
};

/// Draws straight into the picture's bytes. Cairo's pixel is blue first where ours is red first: colours are handed
/// over with the two exchanged, and nothing is ever copied. Requires an opaque picture and a little-endian machine.
class Canvas {
 public:
  explicit Canvas(Image& image);
  ~Canvas();
  Canvas(const Canvas&) = delete;
  Canvas& operator=(const Canvas&) = delete;

  /// One line of text, `at` on its baseline. Figures are tabular. @return its width.
  double text(Point at, const std::string& words, const TextStyle& style);
  [[nodiscard]] TextExtent measure(const std::string& words, const TextStyle& style);
  /// `words` turned a quarter to the left about its middle.
  void vertical_text(Point middle, const std::string& words, const TextStyle& style);

  void fill_rectangle(double x, double y, double width, double height, Colour colour, double opacity = 1,
                      double corner = 0);
  void fill_polygon(std::span<const Point> loop, Colour colour, double opacity = 1);
  /// Inside by the even-odd rule.
  void fill_rings(std::span<const std::vector<Point>> rings, Colour colour, double opacity = 1);
  void stroke(std::span<const Point> line, double width, Colour colour, double opacity = 1, bool dashed = false);
  void fill_circle(Point centre, double radius, Colour colour, double opacity = 1);

 private:
  void set_colour(Colour colour, double opacity);
  [[nodiscard]] PangoLayout* layout(const std::string& words, const TextStyle& style);

  cairo_surface_t* surface_;
  cairo_t* cairo_;
  PangoLayout* layout_;
  PangoFontDescription* font_;
};

}  // namespace pd::render::detail
