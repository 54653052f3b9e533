#include <fmt/format.h>

#include <filesystem>
#include <set>

#include "bench/contact/contact_report.hpp"
#include "pd/render/chart.hpp"

namespace pd::bench {

namespace {

/// One figure over the scenes, a line for each run.
render::Chart chart_of(const std::vector<ContactRow>& rows, double rate, const std::string& setting,
                       const std::string& label, double ContactFigures::*field) {
  render::Chart chart;
  chart.title = fmt::format("{}: {:.0f} Hz, {} settings", label, rate, setting);
  chart.y_label = label;
  chart.y_scale = render::Scale::logarithmic;
  std::vector<std::string> names;
  for (const ContactRow& row : rows) {
    if (row.steps_per_second != rate || row.setting != setting) continue;
    if (names.empty() || names.back() != row.scene) {
      names.push_back(row.scene);
      std::string& line = names.size() <= 10 ? chart.subtitle : chart.x_label;  // as much as a line holds
      line += fmt::format("{}{} {}", line.empty() ? "" : ", ", names.size(), row.scene);
    }
    auto series =
        std::find_if(chart.series.begin(), chart.series.end(), [&](const auto& s) { return s.name == row.run; });
    if (series == chart.series.end()) {
      series = chart.series.insert(series, render::Series{row.run, {}, {}, true});
    }
    series->x.push_back(static_cast<double>(names.size()));
    series->y.push_back(row.figures.*field);
  }
  return chart;
}

}  // namespace

bool plot_contact(const std::vector<ContactRow>& rows, const std::string& folder) {
  std::set<std::pair<double, std::string>> pictures;
  for (const ContactRow& row : rows) pictures.insert({row.steps_per_second, row.setting});
  bool written = true;
  for (const auto& [rate, setting] : pictures) {
    for (const auto& [name, label, field] :
         {std::tuple{"step_ms", "ms a step, median", &ContactFigures::step_p50_ms},
          std::tuple{"drift", "drift in body sizes", &ContactFigures::drift},
          std::tuple{"deepest", "deepest penetration, last quarter, in body sizes", &ContactFigures::deepest_late}}) {
      const auto path = std::filesystem::path(folder) / fmt::format("contact_{}_{:.0f}hz_{}.png", name, rate, setting);
      const auto png =
          render::write_png(render::draw_chart(chart_of(rows, rate, setting, label, field), {1500, 800}), path);
      if (!png) {
        fmt::print(stderr, "{}: {}\n", path.string(), png.error().message);
        written = false;
      }
    }
  }
  return written;
}

}  // namespace pd::bench
