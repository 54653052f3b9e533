#include "pd/render/composition.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "text/canvas.hpp"

namespace pd::render {
namespace {

using detail::Align;
using detail::Canvas;

/// Bands above and below the panels, and the gap between them, in pixels.
struct Bands {
  int header;
  int footer;
  int gap;
};

Bands bands_of(Size whole) {
  const double u = whole.height / 720.0;
  return {static_cast<int>(std::lround(96 * u)), static_cast<int>(std::lround(64 * u)),
          std::max(2, static_cast<int>(std::lround(4 * u)))};
}

}  // namespace

Size panel_size(Size whole, int count) {
  assert(count >= 1);
  const Bands bands = bands_of(whole);
  return {std::max(16, (whole.width - bands.gap * (count - 1)) / count),
          std::max(16, whole.height - bands.header - bands.footer)};
}

Image side_by_side(std::span<const Panel> panels, const std::string& title, const std::string& statement, Size whole) {
  assert(!panels.empty());
  const double u = whole.height / 720.0;
  const Bands bands = bands_of(whole);
  const Size size = panel_size(whole, static_cast<int>(panels.size()));
  Image image(whole, palette::kPaper);
  int x = 0;
  for (const Panel& panel : panels) {
    image.paste(panel.image.size() == size ? panel.image : resized(panel.image, size), x, bands.header);
    x += size.width + bands.gap;
  }
  Canvas canvas(image);
  const double margin = 36 * u;
  canvas.text({margin, 42 * u}, title, {.size = 27 * u, .weight = 650});
  x = 0;
  for (const Panel& panel : panels) {
    canvas.text({x + margin, 80 * u}, panel.heading, {.size = 18 * u, .weight = 550, .colour = palette::kInkSoft});
    x += size.width + bands.gap;
  }
  canvas.text({0.5 * whole.width, whole.height - 24 * u}, statement,
              {.size = 23 * u, .weight = 600, .colour = palette::kInk, .align = Align::centre});
  return image;
}

Image film_strip(std::span<const Panel> frames, const std::string& title, int width) {
  assert(!frames.empty());
  const auto count = static_cast<int>(frames.size());
  const int columns = std::min(count, 3);
  const int rows = (count + columns - 1) / columns;
  const double u = width / 1800.0;
  const int margin = static_cast<int>(std::lround(40 * u));
  const int gap = static_cast<int>(std::lround(16 * u));
  const int header = title.empty() ? margin : static_cast<int>(std::lround(104 * u));
  const int caption = static_cast<int>(std::lround(38 * u));
  const Size source = frames.front().image.size();
  const int cell_width = (width - 2 * margin - (columns - 1) * gap) / columns;
  const int cell_height = std::max(1, cell_width * source.height / source.width);
  Image strip({width, header + rows * (cell_height + caption) + (rows - 1) * gap + margin / 2}, palette::kPaper);
  for (int i = 0; i < count; ++i) {
    const int x = margin + (i % columns) * (cell_width + gap);
    const int y = header + (i / columns) * (cell_height + caption + gap);
    strip.paste(resized(frames[static_cast<std::size_t>(i)].image, {cell_width, cell_height}), x, y);
  }
  Canvas canvas(strip);
  canvas.text({static_cast<double>(margin), 66 * u}, title, {.size = 34 * u, .weight = 650});
  for (int i = 0; i < count; ++i) {
    const double x = margin + (i % columns) * (cell_width + gap);
    const double y = header + (i / columns) * (cell_height + caption + gap) + cell_height;
    canvas.text({x, y + 27 * u}, frames[static_cast<std::size_t>(i)].heading,
                {.size = 20 * u, .weight = 500, .colour = palette::kInkSoft});
  }
  return strip;
}

}  // namespace pd::render
