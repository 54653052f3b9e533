/// @file
/// Several pictures as one argument: side by side with the difference said in words, and film strips.
#pragma once

#include <span>
#include <string>

#include "pd/render/image.hpp"

namespace pd::render {

struct Panel {
  Image image;
  std::string heading;  ///< "exact", "Bullet EPA"; strips: the time
};

/// Size that each of `count` panels must have, so that `side_by_side` fills `whole` without scaling.
[[nodiscard]] Size panel_size(Size whole, int count);

/// Panels next to each other under a shared title, over a line that states the difference ("drift 0.4 mm / 37 mm").
/// Panels of another size than `panel_size` are scaled to it.
[[nodiscard]] Image side_by_side(std::span<const Panel> panels, const std::string& title, const std::string& statement,
                                 Size whole);

/// Two rows of three (or one row for up to three) scaled frames with their times, under a title.
/// @param width  of the whole strip; the height follows from the frames' shape.
[[nodiscard]] Image film_strip(std::span<const Panel> frames, const std::string& title, int width = 1800);

}  // namespace pd::render
