/// @file
/// A stranger's program on render: a chart drawn, written as PNG and read back.
#include <cstdio>
#include <pd/render/chart.hpp>
#include <pd/render/image.hpp>

int main() {
  pd::render::Chart chart;
  chart.title = "depth";
  chart.series = {{.name = "pi", .x = {0, 1, 2}, .y = {0, 0.25, 0.5}}};
  const pd::render::Image drawn = pd::render::draw_chart(chart, {320, 180});
  const auto path = pd::render::write_png(drawn, "stranger_chart.png");
  if (!path) {
    return 1;
  }
  const auto read = pd::render::read_png(*path);
  if (!read) {
    return 1;
  }
  std::printf("picture %d x %d, difference %d\n", read->width(), read->height(),
              pd::render::difference(drawn, *read).largest);
}
