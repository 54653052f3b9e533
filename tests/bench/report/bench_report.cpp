#include "bench/report/bench_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include "bench/measure/stopwatch.hpp"
#include "bench/peers/solver.hpp"
#include "report/charts.hpp"
#include "report/html_text.hpp"

namespace pd::bench {

namespace {

using Rank = report::Card::Rank;

bool is_ours(const std::string& solver) { return solver.starts_with("pdepth"); }

/// Solvers in the order in which they first come.
template <class Rows>
std::vector<std::string> solvers_of(const Rows& rows) {
  std::vector<std::string> names;
  for (const auto& row : rows) {
    if (std::find(names.begin(), names.end(), row.solver) == names.end()) names.push_back(row.solver);
  }
  return names;
}

/// What a solver shows over all cells.
struct Totals {
  std::vector<double> ratios;
  std::vector<double> times;
  double asked = 0;
  double wrong = 0;
  double allocations = 0;

  void add(double ratio, double nanoseconds, int questions, int wrong_ones, double allocations_each) {
    ratios.push_back(ratio);
    times.push_back(nanoseconds);
    asked += questions;
    wrong += wrong_ones;
    allocations += allocations_each * questions;
  }
};

template <class Rows, class Questions>
std::map<std::string, Totals> totals_of(const Rows& rows, Questions&& questions) {
  std::map<std::string, Totals> totals;
  for (const auto& row : rows) {
    totals[row.solver].add(row.ratio_to_bullet, row.p50_ns, questions(row), row.wrong, row.allocations);
  }
  return totals;
}

/// Bars of time, beside Bullet's where it took part, and of wrong answers.
std::string solver_bars(const std::vector<std::string>& solvers, std::map<std::string, Totals>& totals) {
  const bool beside_bullet = totals.contains(std::string(kBulletEpa));
  report::BarChart times{beside_bullet ? "Time of a query, over that of Bullet's EPA" : "Time of a query",
                         "Medians of the cells, geometric mean over all; the axis is logarithmic.",
                         {},
                         true};
  report::BarChart wrong{"Wrong answers", "Judged by the oracle, of all questions.", {}};
  for (const std::string& name : solvers) {
    const Totals& total = totals[name];
    const double time = geometric_mean(beside_bullet ? total.ratios : total.times);
    const std::string shown = !std::isfinite(time) ? "-"
                              : beside_bullet      ? fmt::format("{:.3g} x", time)
                                                   : report::quantity(1e-9 * time, "s");
    times.bars.push_back({name, time, shown, is_ours(name)});
    const double share = total.asked > 0 ? total.wrong / total.asked : 0;
    wrong.bars.push_back({name, share, fmt::format("{:.0f} ({:.3g} %)", total.wrong, 100 * share), is_ours(name)});
  }
  return report::bar_chart(times) + report::bar_chart(wrong);
}

std::vector<report::Card> solver_cards(std::map<std::string, Totals>& totals, std::size_t cells,
                                       std::string_view cell_name, std::string_view question_name) {
  double asked = 0;
  double wrong = 0;
  double most = 0;
  for (const auto& [name, total] : totals) {
    most = std::max(most, total.asked);
    if (!is_ours(name)) continue;
    asked += total.asked;
    wrong += total.wrong;
  }
  std::vector<report::Card> cards{{fmt::format("{}", cells), std::string(cell_name), Rank::plain},
                                  {fmt::format("{:.0f}", most), std::string(question_name), Rank::plain}};
  if (asked > 0) {
    cards.push_back({fmt::format("{:.0f}", wrong), "of pdepth's answers wrong", wrong == 0 ? Rank::good : Rank::bad});
  }
  const auto ours = totals.find("pdepth-auto");
  if (ours != totals.end() && std::isfinite(geometric_mean(ours->second.ratios))) {
    cards.push_back({fmt::format("{:.3g} x", geometric_mean(ours->second.ratios)),
                     "of the time of Bullet's EPA (pdepth-auto)", Rank::plain});
  }
  if (ours != totals.end() && ours->second.asked > 0) {
    cards.push_back({fmt::format("{:.2g}", ours->second.allocations / ours->second.asked),
                     "allocations a query (pdepth-auto)", Rank::plain});
  }
  return cards;
}

/// Time by size, a plot for each family that comes in several.
std::string size_plots(const std::vector<Row>& rows) {
  // family -> solver -> vertices -> times of its depths
  std::map<std::string, std::map<std::string, std::map<int, std::vector<double>>>> times;
  for (const Row& row : rows) times[row.family][row.solver][row.vertices].push_back(row.p50_ns);
  std::vector<std::string> figures;
  for (const auto& [family, solvers] : times) {
    report::LinePlot plot{family, "vertices of each body", "s", {}};
    bool grows = false;
    for (const std::string& name : solvers_of(rows)) {
      const auto found = solvers.find(name);
      if (found == solvers.end()) continue;
      report::LinePlot::Line line{name, {}, {}};
      for (const auto& [vertices, each] : found->second) {
        line.x.push_back(vertices);
        line.y.push_back(1e-9 * geometric_mean(each));
      }
      grows = grows || line.x.size() > 1;
      plot.lines.push_back(std::move(line));
    }
    if (grows) figures.push_back(report::line_plot(plot));
  }
  if (figures.empty()) return {};
  return "<section id=\"sizes\"><h2>Time of a query by size</h2>\n"
         "<p class=\"quiet\">Medians, geometric mean over the depths.</p>\n" +
         report::charts(figures) + "</section>\n";
}

/// A word as a shell takes it.
std::string quoted(std::string_view word) {
  const bool plain = !word.empty() && word.find_first_not_of(
                                          "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                                          "-_./,=:+") == std::string_view::npos;
  if (plain) return std::string(word);
  std::string text = "'";
  for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

}  // namespace

bool write_report(const ReportTarget& target, const BenchReport& content) {
  if (target.folder.empty()) return true;
  report::Page page;
  page.title = content.title;
  page.text = content.text;
  page.cards = content.cards;
  page.sections = content.charts;
  for (const report::CsvTable& table : content.tables) page.sections.push_back(report::csv_section(table));
  page.commands = {target.command};
  page.seed = target.seed;
  const bool good = report::write_page(target.folder, page) && report::write_tables(target.folder, content.tables) &&
                    report::write_tables(target.folder, content.files);
  if (!good) fmt::print(stderr, "--report: {} cannot be written\n", target.folder);
  return good;
}

BenchReport report_of_pairs(const std::vector<Row>& rows, const std::string& what) {
  auto totals = totals_of(rows, [](const Row& row) { return row.pairs; });
  const auto solvers = solvers_of(rows);
  const std::size_t cells = solvers.empty() ? 0 : rows.size() / solvers.size();
  BenchReport content;
  content.title = what + ": penetration depth beside the peers";
  content.text =
      "Solvers answer the same pairs in turns; every answer is judged in exact arithmetic. A cell is a family of "
      "bodies "
      "of one size at one depth.";
  content.cards = solver_cards(totals, cells, "cells", "pairs, asked of each solver");
  content.charts = {"<section id=\"solvers\"><h2>Solvers</h2>\n" + solver_bars(solvers, totals) + "</section>\n",
                    size_plots(rows)};
  content.tables = {{"cells", "All cells", "p50 and p99 of one query; ratios are of medians.", to_csv(rows)}};
  return content;
}

BenchReport report_of_coherent(const std::vector<CoherentRow>& rows) {
  auto totals = totals_of(rows, [](const CoherentRow& row) { return row.frames; });
  const auto solvers = solvers_of(rows);
  const std::size_t sequences = solvers.empty() ? 0 : rows.size() / solvers.size();
  BenchReport content;
  content.title = "Sequences of frames: penetration depth with the memory of the pair";
  content.text =
      "Two bodies turn a little from frame to frame; a solver that can remember the pair does. Every frame of every "
      "solver is judged in exact arithmetic.";
  content.cards = solver_cards(totals, sequences, "sequences", "frames, asked of each solver");
  report::BarChart worst{"Longest run of wrong frames", "Of any sequence.", {}};
  for (const std::string& name : solvers) {
    int longest = 0;
    for (const CoherentRow& row : rows)
      longest = row.solver == name ? std::max(longest, row.longest_wrong_run) : longest;
    worst.bars.push_back({name, static_cast<double>(longest), fmt::format("{}", longest), is_ours(name)});
  }
  content.charts = {"<section id=\"solvers\"><h2>Solvers</h2>\n" + solver_bars(solvers, totals) +
                    report::bar_chart(worst) + "</section>\n"};
  content.tables = {{"sequences", "All sequences",
                     "step: radians a frame; depth: the overlap as a share of the size; warm share: frames answered "
                     "from the memory of the pair.",
                     to_csv(rows)}};
  return content;
}

BenchReport report_of_comparison(const std::vector<Comparison>& comparisons, const std::string& words) {
  BenchReport content;
  content.title = "Two builds, run in turns on the same pairs";
  content.text = words;
  std::vector<double> ratios;
  int faster = 0;
  int slower = 0;
  report::CsvTable table{"cells", "All cells",
                         "A cell has changed where every round says so; ratios are of medians, after over before, each "
                         "over Bullet's EPA of its own run where that took part.",
                         "family,vertices,depth,solver,before_ns,after_ns,ratio,least,largest,verdict\n"};
  for (const Comparison& c : comparisons) {
    if (c.solver == kBulletEpa) continue;
    const std::string_view word = verdict_of(c);
    faster += word == "faster" ? 1 : 0;
    slower += word == "SLOWER" ? 1 : 0;
    ratios.push_back(c.ratio);
    table.csv += fmt::format("{},{},{},{},{:.1f},{:.1f},{:.4f},{:.4f},{:.4f},{}\n", c.family, c.vertices, c.depth,
                             c.solver, c.before_ns, c.after_ns, c.ratio, c.least, c.largest, word);
  }
  content.cards = {
      {fmt::format("{:.3f}", geometric_mean(ratios)), "time after over before, geometric mean", Rank::plain},
      {fmt::format("{}", faster), "cells faster in every round", Rank::plain},
      {fmt::format("{}", slower), "cells slower in every round", slower == 0 ? Rank::good : Rank::bad},
      {fmt::format("{}", ratios.size()), "cells", Rank::plain}};
  content.tables = {std::move(table)};
  return content;
}

BenchReport report_of_hash(const HashOutcome& outcome) {
  BenchReport content;
  content.title = "The bits of answers, hashed";
  content.text =
      "A row is one kind of question; its hash is that of all bits of all its answers in order. It is the same on "
      "every "
      "compiler, instruction set and machine.";
  content.cards = {{fmt::format("{}", outcome.answers), "answers", Rank::plain},
                   {fmt::format("{}", outcome.rows), "kinds of questions", Rank::plain}};
  if (outcome.compared) {
    content.cards.push_back({fmt::format("{}", outcome.differing), "kinds that differ from the file",
                             outcome.differing == 0 ? Rank::good : Rank::bad});
  }
  content.tables = {{"hashes", "All kinds", "", outcome.csv}};
  return content;
}

std::string command_line(int argc, const char* const* argv, const std::string& seed) {
  std::string text = "pdepth-bench";
  bool seeded = false;
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    seeded = seeded || word == "--seed" || word.starts_with("--seed=");
    // What follows "--" belongs to another program.
    if (word == "--" && !seeded && !seed.empty()) {
      text += " --seed " + seed;
      seeded = true;
    }
    text += " " + quoted(word);
  }
  if (!seeded && !seed.empty()) text += " --seed " + seed;
  return text;
}

}  // namespace pd::bench
