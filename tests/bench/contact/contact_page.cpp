#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "bench/contact/contact_report.hpp"
#include "bench/measure/stopwatch.hpp"
#include "report/charts.hpp"
#include "report/html_text.hpp"

namespace pd::bench {

namespace {

using Rank = report::Card::Rank;

/// A scene, its rate and its settings.
std::string block_of(const ContactRow& row) {
  return fmt::format("{} {} {}", row.scene, row.steps_per_second, row.setting);
}

std::vector<std::string> runs_of(const std::vector<ContactRow>& rows) {
  std::vector<std::string> names;
  for (const ContactRow& row : rows) {
    if (std::find(names.begin(), names.end(), row.run) == names.end()) names.push_back(row.run);
  }
  return names;
}

/// A step's median over that of the run "bullet" in the same block, each run over all blocks that both share.
std::string step_bars(const std::vector<ContactRow>& rows) {
  std::map<std::string, double> bullet;
  for (const ContactRow& row : rows) {
    if (row.run == "bullet") bullet[block_of(row)] = row.figures.step_p50_ms;
  }
  if (bullet.empty()) return {};
  report::BarChart chart{"Time of a step, over Bullet's own",
                         "Medians, geometric mean over scenes, rates and settings; the axis is logarithmic.",
                         {},
                         true};
  for (const std::string& run : runs_of(rows)) {
    std::vector<double> ratios;
    for (const ContactRow& row : rows) {
      const auto found = bullet.find(block_of(row));
      if (row.run == run && found != bullet.end()) ratios.push_back(row.figures.step_p50_ms / found->second);
    }
    const double ratio = geometric_mean(ratios);
    chart.bars.push_back(
        {run, ratio, std::isfinite(ratio) ? fmt::format("{:.3g} x", ratio) : "-", run.starts_with("pdepth")});
  }
  return report::bar_chart(chart);
}

/// How many of the scenes that should stand do.
std::string standing_bars(const std::vector<ContactRow>& rows) {
  report::BarChart chart{"Scenes that stood to their end", "Of those that should, at each rate and setting.", {}};
  for (const std::string& run : runs_of(rows)) {
    int asked = 0;
    int stood = 0;
    for (const ContactRow& row : rows) {
      if (row.run != run || row.goal != scenes::ContactGoal::stand) continue;
      ++asked;
      stood += row.figures.fall_seconds >= row.seconds ? 1 : 0;
    }
    if (asked == 0) return {};
    chart.bars.push_back(
        {run, static_cast<double>(stood), fmt::format("{} of {}", stood, asked), run.starts_with("pdepth")});
  }
  return report::bar_chart(chart);
}

}  // namespace

BenchReport report_of_contact(const std::vector<ContactRow>& rows) {
  const std::vector<ContactVerdict> verdicts = judge_contact(rows);
  const auto good = std::count_if(verdicts.begin(), verdicts.end(), [](const auto& verdict) { return verdict.good; });
  double lost = 0;
  std::vector<std::string> blocks;
  for (const ContactRow& row : rows) {
    if (std::find(blocks.begin(), blocks.end(), block_of(row)) == blocks.end()) blocks.push_back(block_of(row));
    lost += row.run.starts_with("pdepth") ? row.figures.lost : 0;
  }
  BenchReport content;
  content.title = "Worlds under Bullet's ways to find contacts and under pdepth's";
  content.text =
      "The same starts for all, stepped in turns; penetration is measured exactly on the true poses of the sharp "
      "shapes. "
      "Lengths are in units of a scene's body. Each figure is the median over the starts.";
  content.cards = {{fmt::format("{}", blocks.size()), "scenes at their rates and settings", Rank::plain},
                   {fmt::format("{} of {}", good, verdicts.size()), "comparisons that pdepth holds", Rank::plain},
                   {fmt::format("{:.0f}", lost), "bodies lost under pdepth", lost == 0 ? Rank::good : Rank::bad}};
  content.charts = {"<section id=\"runs\"><h2>Ways to find contacts</h2>\n" + step_bars(rows) + standing_bars(rows) +
                    "</section>\n"};
  report::CsvTable judged{"verdicts", "pdepth against the best of the others",
                          "\"may be\" is what the figure is held to: the best other's, with the slack that the bench "
                          "states.",
                          "scene,Hz,settings,figure,ours,best_other,may_be,verdict\n"};
  for (const ContactVerdict& v : verdicts) {
    judged.csv += fmt::format("{},{},{},{},{:.6g},{:.6g},{:.6g},{}\n", v.scene, v.steps_per_second, v.setting, v.figure,
                              v.ours, v.best, v.threshold, v.good ? "holds" : "MISSED");
  }
  content.tables = {std::move(judged), {"figures", "All figures", "", to_csv(rows)}};
  return content;
}

}  // namespace pd::bench
