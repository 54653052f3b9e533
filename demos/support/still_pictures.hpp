/// @file
/// A demo that is a row of pictures, each drawn by one function.
#pragma once

#include <span>
#include <string_view>

#include "pd/numeric/expected.hpp"
#include "pd/render/renderer.hpp"
#include "support/demo_options.hpp"

namespace pd::demo {

struct StillPicture {
  std::string_view name;     ///< of the file, without its ending
  std::string_view caption;  ///< of a page
  Expected<render::Image> (*draw)(render::Renderer& renderer, render::Size size);
};

/// Draws them in turn into the demo's folder and names each file on stdout. @param title  of the section on a page.
/// @return one of DemoExit.
int draw_still_pictures(const DemoOptions& options, std::string_view demo, std::string_view title,
                        std::span<const StillPicture> pictures);

}  // namespace pd::demo
