/// @file
/// Pictures of the plane: regions with holes, curves, an arrow that says how far, over a quiet grid with its scale.
#pragma once

#include <string>
#include <vector>

#include "pd/planar/contact.hpp"
#include "pd/render/image.hpp"
#include "pd/render/palette.hpp"

namespace pd::render {

/// A filled area: inside by the even-odd rule, so that rings inside others are holes.
struct PlaneRegion {
  std::vector<std::vector<Point2>> rings;
  Colour colour = palette::kBodyA;
  double opacity = 1;
  double outline_pixels = 1.5;  ///< of a picture of 720 lines; a darker tone of the colour; 0: none
  bool dashed = false;          ///< the outline
};

struct PlaneLine {
  std::vector<Point2> points;
  Colour colour = palette::kInk;
  double width_pixels = 2;
  double opacity = 1;
  bool dashed = false;
};

/// Bold, with a light rim, above everything; the label stands beside its middle.
struct PlaneArrow {
  Point2 from;
  Point2 to;
  std::string label = {};
  Colour colour = palette::kDepth;
};

struct PlaneDot {
  Point2 at;
  double radius_pixels = 5;
  Colour colour = palette::kContact;
  std::string label = {};  ///< to the right of it
};

/// Parts listed first lie lowest; regions below lines below dots below arrows.
struct PlaneFigure {
  std::vector<PlaneRegion> regions = {};
  std::vector<PlaneLine> lines = {};
  std::vector<PlaneDot> dots = {};
  std::vector<PlaneArrow> arrows = {};
  std::string unit = {};  ///< of the scale bar: "mm"; empty: plain numbers
  bool y_down = false;    ///< as in SVG
  int legend_lines = 0;   ///< room kept free at the top for a legend of so many entries
};

/// Frames everything with air round it. Requires a finite point at least.
[[nodiscard]] Image draw_plane_figure(const PlaneFigure& figure, Size size);

}  // namespace pd::render
