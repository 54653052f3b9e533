/// @file
/// Several pictures as one argument: side by side with the difference said in words, and film strips.
#pragma once

#include <span>
#include <string>

#include "pd/render/annotation.hpp"
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

/// One moment of two courses of things.
struct Moment {
  Image left;
  Image right;
  std::string time;
  Headline left_figure;  ///< set below the picture, in large type; its meaning is said once, for the whole strip
  Headline right_figure;
};

/// The words of a strip of moments that hold for all of them.
struct StripWords {
  std::string title;
  std::string left;       ///< what the left picture of each moment shows
  std::string right;      ///< what the right one shows
  std::string statement;  ///< what the figures below the pictures are
};

/// Size of each picture of a moment, so that `moment_strip` scales none.
[[nodiscard]] Size moment_size(int width = 1800);

/// Moments three a row, each two pictures and two figures. Words are set for a strip that a page shows at half its
/// width: none is smaller than 24 pixels of 1800.
[[nodiscard]] Image moment_strip(std::span<const Moment> moments, const StripWords& words, int width = 1800);

}  // namespace pd::render
