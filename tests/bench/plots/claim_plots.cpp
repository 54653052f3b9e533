#include "bench/plots/claim_plots.hpp"

#include <fmt/format.h>

#include <cctype>
#include <map>

#include "pd/render/chart.hpp"

namespace pd::bench {

namespace {

/// Letters and digits of a title, for a file's name.
std::string file_name(const std::string& title) {
  std::string name;
  for (const char c : title) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) {
      name += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    } else if (!name.empty() && name.back() != '_') {
      name += '_';
    }
  }
  while (!name.empty() && name.back() == '_') name.pop_back();
  return name + ".png";
}

}  // namespace

bool write_claim_plots(const std::vector<Finding>& findings, const std::filesystem::path& folder) {
  std::map<std::string, render::Chart> charts;
  for (const Finding& f : findings) {
    if (f.growth.x.size() < 3) continue;
    render::Chart& chart = charts[file_name(f.claim.name + " " + f.counter)];
    if (chart.series.empty()) {
      chart.title = fmt::format("{}: {}", f.claim.name, f.counter);
      chart.subtitle = f.claim.statement;
      chart.x_label = f.growth.variable;
      chart.y_label = f.counter;
      chart.x_scale = chart.y_scale = render::Scale::logarithmic;
    }
    render::Series series;
    series.name = f.family;
    series.x = f.growth.x;
    series.y = f.growth.y;
    series.markers = true;
    series.fit_exponent = true;
    series.dashed = chart.series.size() >= render::palette::kSeries.size();
    chart.series.push_back(std::move(series));
  }
  bool written = true;
  for (const auto& [name, chart] : charts) {
    const auto png = render::write_png(render::draw_chart(chart, {1280, 800}), folder / name);
    if (!png) {
      fmt::print(stderr, "{}: {}\n", (folder / name).string(), png.error().message);
      written = false;
    }
  }
  return written;
}

}  // namespace pd::bench
