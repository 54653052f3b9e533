#include <algorithm>
#include <cassert>
#include <cmath>

#include "pd/render/composition.hpp"
#include "text/canvas.hpp"

namespace pd::render {
namespace {

using detail::Align;
using detail::Canvas;

/// Lengths in pixels for a strip of a width.
struct StripLayout {
  explicit StripLayout(int width)
      : unit(width / 1800.0),
        margin(pixels(32)),
        gap(pixels(28)),
        middle(pixels(4)),
        header(pixels(172)),
        above(pixels(40)),
        below(pixels(58)) {
    const int cell = (width - 2 * margin - (kColumns - 1) * gap) / kColumns;
    picture.width = std::max(8, (cell - middle) / 2);
    picture.height = picture.width;
  }
  [[nodiscard]] int pixels(double lengths) const { return static_cast<int>(std::lround(lengths * unit)); }
  [[nodiscard]] int cell_width() const { return 2 * picture.width + middle; }
  [[nodiscard]] int cell_height() const { return above + picture.height + below; }

  static constexpr int kColumns = 3;
  double unit;
  int margin;
  int gap;
  int middle;  ///< between the two pictures of a moment
  int header;
  int above;  ///< a picture: its time
  int below;  ///< a picture: its figure
  Size picture;
};

void draw_header(Canvas& canvas, const StripWords& words, const StripLayout& layout) {
  const double u = layout.unit;
  const double x = layout.margin;
  canvas.text({x, 52 * u}, words.title, {.size = 38 * u, .weight = 650});
  canvas.text({x, 98 * u}, "left: " + words.left + "        right: " + words.right,
              {.size = 26 * u, .weight = 500, .colour = palette::kInkSoft});
  canvas.text({x, 138 * u}, words.statement, {.size = 26 * u, .weight = 500, .colour = palette::kInkSoft});
}

}  // namespace

Size moment_size(int width) { return StripLayout(width).picture; }

Image moment_strip(std::span<const Moment> moments, const StripWords& words, int width) {
  assert(!moments.empty());
  const StripLayout layout(width);
  const auto count = static_cast<int>(moments.size());
  const int rows = (count + StripLayout::kColumns - 1) / StripLayout::kColumns;
  const auto left_of = [&](int i) {
    return layout.margin + (i % StripLayout::kColumns) * (layout.cell_width() + layout.gap);
  };
  const auto top_of = [&](int i) { return layout.header + (i / StripLayout::kColumns) * layout.cell_height(); };
  Image strip({width, layout.header + rows * layout.cell_height() + layout.margin / 2}, palette::kPaper);
  const auto paste = [&](const Image& image, int x, int y) {
    strip.paste(image.size() == layout.picture ? image : resized(image, layout.picture), x, y);
  };
  for (int i = 0; i < count; ++i) {
    const Moment& moment = moments[static_cast<std::size_t>(i)];
    paste(moment.left, left_of(i), top_of(i) + layout.above);
    paste(moment.right, left_of(i) + layout.picture.width + layout.middle, top_of(i) + layout.above);
  }
  Canvas canvas(strip);
  draw_header(canvas, words, layout);
  const double u = layout.unit;
  for (int i = 0; i < count; ++i) {
    const Moment& moment = moments[static_cast<std::size_t>(i)];
    const double x = left_of(i);
    const double base = top_of(i) + layout.above + layout.picture.height + 34 * u;
    canvas.text({x, top_of(i) + 28 * u}, moment.time, {.size = 26 * u, .weight = 600, .colour = palette::kInkSoft});
    for (const bool right : {false, true}) {
      const Headline& figure = right ? moment.right_figure : moment.left_figure;
      const double centre = x + 0.5 * layout.picture.width + (right ? layout.picture.width + layout.middle : 0);
      canvas.text({centre, base}, figure.value,
                  {.size = 27 * u, .weight = 650, .colour = figure.colour, .align = Align::centre});
    }
  }
  return strip;
}

}  // namespace pd::render
