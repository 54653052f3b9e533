#include "bench/plots/plots.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "pd/render/chart.hpp"

namespace pd::bench {

namespace {

/// Those whose answers are meant to be the penetration depth; six colours tell them apart.
constexpr std::string_view kDrawn[] = {"pdepth-auto",  "bullet-epa", "pdepth-overlay",
                                       "fcl-distance", "ccd-epa",    "bullet-minkowski"};

render::Chart chart_of(const std::vector<Row>& rows, const std::string& family, const std::string& depth) {
  render::Chart chart;
  chart.title = fmt::format("{}, {}: time of one cold pair", family, depth);
  chart.subtitle = "Median over the pairs of a cell; hulls of n vertices each. Dashed: more than 1 % wrong answers.";
  chart.x_label = "vertices n";
  chart.y_label = "nanoseconds";
  chart.x_scale = chart.y_scale = render::Scale::logarithmic;
  int colour = 0;
  for (const std::string_view solver : kDrawn) {
    render::Series series;
    series.name = solver;
    series.markers = true;
    series.fit_exponent = true;
    series.colour = colour++;
    int pairs = 0;
    int wrong = 0;
    for (const Row& r : rows) {
      if (r.family != family || r.depth != depth || r.solver != solver) continue;
      series.x.push_back(r.vertices);
      series.y.push_back(r.p50_ns);
      pairs += r.pairs;
      wrong += r.wrong;
    }
    series.dashed = 100 * wrong > pairs;
    if (!series.x.empty()) chart.series.push_back(std::move(series));
  }
  return chart;
}

}  // namespace

bool write_plots(const std::vector<Row>& rows, const std::filesystem::path& folder) {
  std::set<std::pair<std::string, std::string>> pictures;
  for (const Row& r : rows) pictures.insert({r.family, r.depth});
  bool written = true;
  for (const auto& [family, depth] : pictures) {
    std::set<int> sizes;
    for (const Row& r : rows) {
      if (r.family == family) sizes.insert(r.vertices);
    }
    if (sizes.size() < 3) continue;
    const std::filesystem::path path = folder / fmt::format("{}_{}.png", family, depth);
    const auto png = render::write_png(render::draw_chart(chart_of(rows, family, depth), {1280, 800}), path);
    if (!png) {
      fmt::print(stderr, "{}: {}\n", path.string(), png.error().message);
      written = false;
    }
  }
  return written;
}

}  // namespace pd::bench
