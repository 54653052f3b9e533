#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bench/agarwal/agarwal.hpp"
#include "bench/report/bench_report.hpp"
#include "report/charts.hpp"
#include "report/html_text.hpp"

namespace pd::bench {

namespace {

using Rank = report::Card::Rank;

bool is_time(const Growth& growth) { return growth.counter.ends_with(", ns"); }

/// "families of one counter over one variable", in one plot.
struct Family {
  const Finding* first;
  report::LinePlot plot;
};

void add_line(const Finding& finding, std::vector<Family>& plots) {
  const Growth& growth = finding.growth;
  if (growth.x.size() < 2) return;
  auto place = std::find_if(plots.begin(), plots.end(), [&](const Family& known) {
    return known.first->growth.counter == growth.counter && known.first->growth.variable == growth.variable;
  });
  if (place == plots.end()) {
    const std::string name = is_time(growth) ? growth.counter.substr(0, growth.counter.size() - 4) : growth.counter;
    place = plots.insert(plots.end(), {&finding, {name, growth.variable, is_time(growth) ? "s" : "", {}}});
  }
  report::LinePlot::Line line{finding.family, growth.x, growth.y};
  if (is_time(growth)) {
    for (double& value : line.y) value *= 1e-9;
  }
  if (std::isfinite(finding.fit.exponent)) line.name += fmt::format(", exponent {:.2f}", finding.fit.exponent);
  if (finding.verdict != Verdict::reported) line.name += fmt::format(" ({})", to_string(finding.verdict));
  place->plot.lines.push_back(std::move(line));
}

/// One claim: its statement and a plot for each counter.
std::string claim_plots(const Claim& claim, const std::vector<Finding>& findings) {
  std::vector<Family> plots;
  for (const Finding& finding : findings) {
    if (finding.claim.name == claim.name) add_line(finding, plots);
  }
  std::vector<std::string> figures;
  for (const Family& family : plots) figures.push_back(report::line_plot(family.plot));
  if (std::all_of(figures.begin(), figures.end(), [](const std::string& figure) { return figure.empty(); })) return {};
  return fmt::format("<h3>{}</h3>\n<p class=\"quiet\">{}</p>\n", report::escaped(claim.name),
                     report::escaped(claim.statement)) +
         report::charts(figures);
}

}  // namespace

BenchReport report_of_claims(const ClaimTable& table, const std::string& what) {
  const std::vector<Finding> findings = table.by_claim();
  int verdicts[4] = {};
  double wrong = 0;
  bool counts_wrong = false;
  for (const Finding& finding : findings) {
    ++verdicts[static_cast<std::size_t>(finding.verdict)];
    if (finding.counter != kWrongAnswers) continue;
    counts_wrong = true;
    wrong += finding.figure;
  }
  const auto card = [&](Verdict verdict, std::string meaning, Rank some) {
    const int count = verdicts[static_cast<std::size_t>(verdict)];
    return report::Card{fmt::format("{}", count), std::move(meaning), count == 0 ? Rank::plain : some};
  };
  BenchReport content;
  content.title = what;
  content.text =
      "Exponents are least-squares slopes over logarithms with their 95 % intervals; times are processor times of the "
      "fastest of several runs, in turns.";
  content.cards = {card(Verdict::holds, "bounds hold", Rank::good), card(Verdict::fails, "bounds fail", Rank::bad),
                   card(Verdict::undecided, "undecided: the bound lies within the interval", Rank::plain),
                   card(Verdict::reported, "figures without a bound", Rank::plain)};
  if (counts_wrong) {
    content.cards.push_back({fmt::format("{:.0f}", wrong), "wrong answers", wrong == 0 ? Rank::good : Rank::bad});
  }
  std::string growth;
  const Finding* last = nullptr;
  for (const Finding& finding : findings) {
    if (last == nullptr || last->claim.name != finding.claim.name) growth += claim_plots(finding.claim, findings);
    last = &finding;
  }
  if (!growth.empty()) {
    content.charts = {
        "<section id=\"growth\"><h2>Growth</h2>\n"
        "<p class=\"quiet\">Both axes are logarithmic: a power is a straight line, its exponent the slope.</p>\n" +
        growth + "</section>\n"};
  }
  // The verdict before what a narrow page scrolls out of sight.
  content.tables = {{"findings",
                     "All rows",
                     "",
                     to_csv(findings),
                     {"claim", "family", "counter", "range", "figure", "exponent", "bound", "verdict", "low", "high",
                      "last_doubling"}}};
  content.files = {{"points", "", "", points_csv(findings)}};
  return content;
}

}  // namespace pd::bench
