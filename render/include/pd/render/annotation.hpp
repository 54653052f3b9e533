/// @file
/// The words round a frame: caption, time, headline figures, sparkline, legend.
#pragma once

#include <string>
#include <vector>

#include "pd/render/image.hpp"
#include "pd/render/palette.hpp"

namespace pd::render {

/// A figure worth a large type: "0.4 mm" over "largest drift".
struct Headline {
  std::string value;
  std::string meaning;
  Colour colour = palette::kInk;
};

/// A thin curve along the bottom; the part after `now` is faint.
struct Sparkline {
  std::vector<double> values = {};   ///< one a step, non-negative
  std::size_t now = 0;               ///< index of the present step
  std::string meaning = {};          ///< "deepest penetration"
  double full_scale = 0;             ///< value of the full height; 0: the largest value (shared scales pass their own)
  std::string full_scale_text = {};  ///< "12 mm", beside the full height
  Colour colour = palette::kDepth;
};

struct LegendEntry {
  Colour colour;
  std::string text;
};

struct Annotation {
  std::string title = {};     ///< top left, large
  std::string subtitle = {};  ///< below it, quiet: solver, margin
  std::string status = {};    ///< bottom left: time and step
  std::vector<Headline> headlines = {};
  Sparkline sparkline = {};
  std::vector<LegendEntry> legend = {};  ///< top right
};

/// Sets the annotation into the picture; type sizes follow the picture's height (720 lines = 1).
void annotate(Image& image, const Annotation& annotation);

}  // namespace pd::render
