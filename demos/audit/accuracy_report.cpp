#include "audit/accuracy_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report/html_text.hpp"

namespace pd::audit {

namespace {

using report::escaped;
using report::short_number;

/// What else is to be said of an engine: a program that wrote no record, pairs at which the engine ended.
std::string words_of(const AccuracyRow& row) {
  std::string text = row.failed ? "a run failed" : "";
  if (row.aborted == 0) return text;
  if (!text.empty()) text += ", ";
  return text + fmt::format("{} of \"no answer\" ended the program", row.aborted);
}

std::string engine_table(const AccuracyTable& table) {
  std::string text = fmt::format("{:<24} {:>8} {:>7} {:>8} {:>7} {:>7} {:>9} {:>9} {:>9}\n", "engine", "contacts",
                                 "missed", "phantom", "> 1e-6", "> 1e-3", "no answer", "worst", "us");
  for (std::size_t e = 0; e < table.engines.size(); ++e) {
    const AccuracyRow row = table.total(e);
    text += fmt::format("{:<24} {:>8} {:>7} {:>8} {:>7} {:>7} {:>9} {:>9.2g} {:>9.1f}{}\n", row.engine, row.contacts,
                        row.missed, row.phantom, row.above_small, row.above_large, row.no_answer, row.worst,
                        row.nanoseconds / 1e3, words_of(row).empty() ? "" : "  " + words_of(row));
  }
  return text + "us: a query's median in a family, geometric mean over the families that the engine takes\n";
}

std::string cell_text(const AccuracyRow& row) {
  return row.failed ? "failed" : row.contacts == 0 ? "-" : row.wrong() == 0 ? "." : fmt::format("{}", row.wrong());
}

/// Families down, engines across: contacts that a user would call wrong.
std::string family_table(const AccuracyTable& table) {
  std::string text = "\nmissed, phantom, wrong by more than 1e-3 or without an answer, of the contacts of a family\n";
  for (std::size_t e = 0; e < table.engines.size(); ++e) text += fmt::format("  {} = {}\n", e + 1, table.engines[e]);
  text += fmt::format("\n{:<20}", "family");
  for (std::size_t e = 0; e < table.engines.size(); ++e) text += fmt::format(" {:>7}", e + 1);
  text += "\n";
  for (std::size_t f = 0; f < table.families.size(); ++f) {
    text += fmt::format("{:<20}", table.families[f]);
    for (std::size_t e = 0; e < table.engines.size(); ++e) text += fmt::format(" {:>7}", cell_text(table.at(e, f)));
    text += "\n";
  }
  return text;
}

std::string totals_section(const AccuracyTable& table) {
  std::vector<std::vector<std::string>> rows{{"engine", "contacts", "missed", "phantom", "error &gt; 1e&#8209;6",
                                              "error &gt; 1e&#8209;3", "no answer", "worst error", "a query"}};
  for (std::size_t e = 0; e < table.engines.size(); ++e) {
    const AccuracyRow row = table.total(e);
    const std::string words = words_of(row);
    rows.push_back({escaped(row.engine + (words.empty() ? "" : " (" + words + ")")), fmt::format("{}", row.contacts),
                    fmt::format("{}", row.missed), fmt::format("{}", row.phantom), fmt::format("{}", row.above_small),
                    fmt::format("{}", row.above_large), fmt::format("{}", row.no_answer), short_number(row.worst),
                    escaped(report::quantity(1e-9 * row.nanoseconds, "s"))});
  }
  return "<section id=\"engines\"><h2>Engines</h2>\n" + report::table(rows, true) +
         "<p class=\"quiet\">Errors are the larger of depth error and normal excess, relative to a pair's "
         "size. A query's time is the processor clock's median in a family, each pair asked once; of an engine, "
         "the geometric mean over the families that it takes.</p></section>\n";
}

/// Shaded by the share that is wrong; the number says the same.
std::string shaded_cell(const AccuracyRow& row) {
  if (row.failed) return "<td class=\"bad\">failed</td>";
  if (row.contacts == 0) return "<td class=\"quiet\">-</td>";
  const double share = static_cast<double>(row.wrong()) / static_cast<double>(row.contacts);
  const int strength = row.wrong() == 0 ? 0 : 12 + static_cast<int>(58 * share);
  return fmt::format(
      "<td style=\"background:color-mix(in srgb,var(--bad) {}%,transparent)\" title=\"{} of {} wrong, worst "
      "{}{}\">{}</td>",
      strength, row.wrong(), row.contacts, short_number(row.worst),
      row.aborted > 0 ? fmt::format("; {} ended the program", row.aborted) : "", row.wrong());
}

std::string families_section(const AccuracyTable& table) {
  std::string text =
      "<section id=\"families\"><h2>Who fails what</h2>\n<p class=\"quiet\">Contacts missed, phantom, wrong by more "
      "than 1e-3 or without an answer; the darker, the larger their share.</p>\n<div class=\"scroll\" "
      "tabindex=\"0\"><table class=\"sortable\"><thead><tr><th>family</th>";
  for (const std::string& engine : table.engines) text += fmt::format("<th>{}</th>", escaped(engine));
  text += "</tr></thead>\n<tbody>\n";
  for (std::size_t f = 0; f < table.families.size(); ++f) {
    text += fmt::format("<tr><td>{}</td>", escaped(table.families[f]));
    for (std::size_t e = 0; e < table.engines.size(); ++e) text += shaded_cell(table.at(e, f));
    text += "</tr>\n";
  }
  return text + "</tbody></table></div></section>\n";
}

}  // namespace

AccuracyRow AccuracyTable::total(std::size_t engine) const {
  AccuracyRow sum;
  sum.engine = engines[engine];
  double logarithms = 0;
  int timed = 0;
  for (std::size_t f = 0; f < families.size(); ++f) {
    const AccuracyRow& row = at(engine, f);
    sum.add(row);
    if (!(row.nanoseconds > 0)) continue;  // a family that the engine does not take, or a recorder without a clock
    logarithms += std::log(row.nanoseconds);
    ++timed;
  }
  if (timed > 0) sum.nanoseconds = std::exp(logarithms / timed);
  return sum;
}

bool AccuracyTable::any_failed() const {
  return std::any_of(rows.begin(), rows.end(), [](const AccuracyRow& row) { return row.failed; });
}

std::string accuracy_text(const AccuracyTable& table) { return engine_table(table) + family_table(table); }

std::string accuracy_csv(const AccuracyTable& table) {
  std::string text = "engine,family,failed,contacts,missed,phantom,above_1e-6,above_1e-3,no_answer,worst,nanoseconds\n";
  for (const AccuracyRow& row : table.rows) {
    text += fmt::format("{},{},{:d},{},{},{},{},{},{},{},{}\n", row.engine, row.family, row.failed, row.contacts,
                        row.missed, row.phantom, row.above_small, row.above_large, row.no_answer, row.worst,
                        row.nanoseconds);
  }
  return text;
}

report::Page accuracy_page(const AccuracyTable& table, const AccuracySettings& settings, const std::string& judge,
                           const std::string& command) {
  using Rank = report::Card::Rank;
  report::Page page;
  page.title = "Who fails what: engines against the exact depth";
  page.text = fmt::format("{} Missed and phantom count beyond {:g} of a pair's size.", judge, settings.tolerance);
  std::int64_t contacts = 0;
  std::size_t right = 0;
  for (std::size_t e = 0; e < table.engines.size(); ++e) {
    const AccuracyRow total = table.total(e);
    contacts += total.contacts;
    right += total.wrong() == 0 && !total.failed ? 1 : 0;
  }
  page.cards = {{fmt::format("{}", table.engines.size()), "engines", Rank::plain},
                {fmt::format("{}", table.families.size()), "families of pairs", Rank::plain},
                {fmt::format("{}", contacts), "contacts judged", Rank::plain},
                {fmt::format("{}", right), "engines without a wrong contact", right > 0 ? Rank::good : Rank::bad}};
  page.sections = {totals_section(table), families_section(table)};
  if (!table.worst.empty()) {
    std::vector<std::string> figures;
    for (const report::PairFigure& figure : table.worst) figures.push_back(report::pair_figure(figure));
    page.sections.push_back("<section id=\"worst\"><h2>The worst contact of each engine</h2>\n" +
                            report::pairs(figures) + "</section>\n");
  }
  page.commands = {command};
  page.seed = fmt::format("{}", settings.seed);
  return page;
}

}  // namespace pd::audit
