/// @file
/// The outline of one element of an SVG file: a path or basic shape with every transform above it applied, in the unit
/// of the page's width.
///
/// What would change the outline and is not understood is refused by its name (style sheets that transform, clip paths,
/// nested pages, copies by <use>); what only changes its looks (fill, stroke) is passed over.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "drawing/svg_text.hpp"

namespace pd::drawing {

struct SvgOutline {
  std::vector<SvgRing> rings;
  /// "mm", "cm", "in", "pt", "pc", "Q" or "px": of the width (else the height) of the page; empty where it has neither.
  std::string unit;
  bool even_odd = false;  ///< fill-rule; else nonzero
  std::string element;    ///< "<path id=\"gear\">", for messages
};

/// @param text  the file's bytes
/// @param id    of the element; empty: the file's only one
/// @throws query::Refusal
[[nodiscard]] SvgOutline read_svg(std::string_view text, const std::string& id);

}  // namespace pd::drawing
