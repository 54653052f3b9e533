/// @file
/// From a page's user units to lengths: width, height, viewBox and preserveAspectRatio of the root element ([SVG]
/// section 8).
#pragma once

#include <pugixml.hpp>
#include <string>

#include "drawing/plane_curve.hpp"

namespace pd::drawing {

struct SvgPage {
  PlaneMap map;      ///< user units to `unit`
  std::string unit;  ///< as `SvgOutline::unit`
};

/// @throws query::Refusal for a relative width or height other than 100 % (which, as no width at all, leaves the user
/// units as they are), an empty viewBox, an alignment that does not exist.
[[nodiscard]] SvgPage read_page(const pugi::xml_node& root);

}  // namespace pd::drawing
