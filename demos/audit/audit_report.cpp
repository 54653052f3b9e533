#include "audit/audit_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "audit/audit_answer.hpp"
#include "audit/contact_figure.hpp"
#include "report/html_text.hpp"

namespace pd::audit {

namespace {

using report::escaped;
using report::short_number;

std::vector<report::Card> cards(const Audit& audit) {
  using Rank = report::Card::Rank;
  const Totals& total = audit.summary.total();
  const auto count = [](std::string_view meaning, std::int64_t n) {
    return report::Card{fmt::format("{}", n), std::string(meaning), n == 0 ? Rank::good : Rank::bad};
  };
  const ErrorQuantiles& depth = total.of(Column::depth_error);
  const bool any = depth.count() > 0;
  return {{fmt::format("{}", total.judged), "contacts judged", Rank::plain},
          count("missed", total.missed),
          count("phantom", total.phantom),
          count("not judged", total.unanswered + audit.summary.refused()),
          {any ? short_number(depth.quantile(0.99)) : "-", "depth error, p99", Rank::plain},
          {any ? short_number(depth.max()) : "-", "depth error, largest", Rank::plain}};
}

std::string table_row(std::string_view kind, const Totals& totals) {
  std::string text = fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td>", escaped(kind),
                                 totals.contacts, totals.missed, totals.phantom, totals.unanswered);
  for (const Column column : {Column::depth_error, Column::normal_excess, Column::point_error}) {
    const ErrorQuantiles& errors = totals.of(column);
    const bool any = errors.count() > 0;
    text += fmt::format("<td>{}</td><td>{}</td>", any ? short_number(errors.quantile(0.99)) : "-",
                        any ? short_number(errors.max()) : "-");
  }
  return text + "</tr>\n";
}

std::string kinds(const AuditSummary& summary) {
  std::string text =
      "<h2>By kind of shapes</h2>\n<div class=\"scroll\" tabindex=\"0\"><table "
      "class=\"sortable\">\n<thead><tr><th>kind</th>"
      "<th>contacts</th><th>missed</th><th>phantom</th><th>no answer</th><th>depth error p99</th><th>max</th>"
      "<th>normal excess p99</th><th>max</th><th>points off p99</th><th>max</th></tr></thead>\n<tbody>\n";
  for (const auto& [kind, totals] : summary.by_kind()) text += table_row(kind, totals);
  // The foot stays where it is when the reader sorts.
  text += "</tbody>\n<tfoot>" + table_row("all", summary.total());
  return text + "</tfoot></table></div>\n";
}

/// Contacts by the power of ten of an error: exact ones, then [1e-17, 1e-16) up to [1, 10), the ends open.
constexpr int kFirstPower = -17;
constexpr int kPowers = 18;

std::array<std::int64_t, kPowers + 1> by_power(const ErrorQuantiles& errors) {
  std::array<std::int64_t, kPowers + 1> counts{};
  counts[0] = errors.zeros();
  errors.each_bin([&](double middle, std::int64_t count) {
    const int power = static_cast<int>(std::floor(std::log10(middle)));
    counts[static_cast<std::size_t>(std::clamp(power - kFirstPower, 0, kPowers - 1)) + 1] += count;
  });
  return counts;
}

/// A histogram; the height of a bar grows with the logarithm of its count.
std::string chart(std::string_view title, const ErrorQuantiles& errors) {
  if (errors.count() == 0) return {};
  constexpr double kLeft = 40;
  constexpr double kStep = 36;
  constexpr double kTop = 12;
  constexpr double kHeight = 120;
  const auto counts = by_power(errors);
  const double most = std::log10(static_cast<double>(*std::max_element(counts.begin(), counts.end()))) + 1;
  const double base = kTop + kHeight;
  std::string text = fmt::format(
      "<h2>{}</h2>\n<div class=\"scroll\" tabindex=\"0\"><svg class=\"histogram\" viewBox=\"0 0 {} 170\" role=\"img\" "
      "aria-label=\"{}: "
      "contacts by power of ten of the "
      "error\">\n",
      title, kLeft + kStep * (kPowers + 1) + 8, title);
  const auto out = std::back_inserter(text);
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const double x = kLeft + kStep * static_cast<double>(i);
    const std::string label = i == 0 ? "0" : fmt::format("1e{}", kFirstPower + static_cast<int>(i) - 1);
    fmt::format_to(out, "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n", x + kStep / 2, base + 16, label);
    if (counts[i] == 0) continue;
    const double height = kHeight * (std::log10(static_cast<double>(counts[i])) + 1) / (most + 0.2);
    fmt::format_to(out,
                   "<rect x=\"{}\" y=\"{:.1f}\" width=\"{}\" height=\"{:.1f}\"><title>{}: {} contacts</title></rect>\n",
                   x + 3, base - height, kStep - 6, height, label, counts[i]);
    fmt::format_to(out, "<text x=\"{}\" y=\"{:.1f}\" text-anchor=\"middle\">{}</text>\n", x + kStep / 2,
                   base - height - 3, counts[i]);
  }
  fmt::format_to(out, "<line x1=\"{}\" y1=\"{}\" x2=\"{}\" y2=\"{}\"/>\n</svg></div>\n", kLeft, base,
                 kLeft + kStep * (kPowers + 1), base);
  return text +
         "<p class=\"quiet\">Contacts by the power of ten from which their error starts, relative to the size of "
         "the pair; heights by the logarithm of the count.</p>\n";
}

std::string worst_contacts(const Audit& audit) {
  if (audit.summary.worst().empty()) return {};
  std::vector<std::string> figures;
  for (const WorstContact& worst : audit.summary.worst()) {
    figures.push_back(report::pair_figure(contact_figure(worst, audit.tolerance)));
  }
  return "<section id=\"worst\"><h2>Worst contacts</h2>\n" + report::pairs(figures) + "</section>\n";
}

std::string conditions_list(const std::vector<ConditionOutcome>& conditions) {
  if (conditions.empty()) return {};
  std::string text = "<h2>Conditions</h2>\n<ul>\n";
  for (const ConditionOutcome& outcome : conditions) {
    text +=
        fmt::format("<li class=\"{}\">{}: {} {:g}, allowed {:g}</li>\n", outcome.holds ? "holds" : "fails",
                    outcome.holds ? "holds" : "fails", outcome.condition.name, outcome.found, outcome.condition.limit);
  }
  return text + "</ul>\n";
}

std::string hints(const AuditSummary& summary) {
  std::string text;
  for (const std::string& hint : recorder_hints(summary)) {
    text += fmt::format("<p class=\"fails\">The recorder may be wrong, not the engine: {}.</p>\n", escaped(hint));
  }
  return text;
}

std::string refused_lines(const AuditSummary& summary) {
  if (summary.refused() == 0) return {};
  std::string text = fmt::format("<h2>Lines refused: {}</h2>\n<ul>\n", summary.refused());
  for (const RefusedLine& line : summary.refusals()) {
    text +=
        fmt::format("<li>line {}: {}: {}</li>\n", line.line, escaped(line.refusal.code), escaped(line.refusal.message));
  }
  return text + "</ul>\n";
}

}  // namespace

report::Page audit_report(const Audit& audit, const std::vector<ConditionOutcome>& conditions, std::string_view record,
                          std::string_view command) {
  const Totals& total = audit.summary.total();
  report::Page page;
  page.title = fmt::format("Contacts of {}", audit.header.engine);
  page.text = fmt::format("{} ({}), judged against the exact answer; counts beyond {:g} of a pair's size.", record,
                          audit.header.single_precision ? "float32" : "float64", audit.tolerance);
  page.cards = cards(audit);
  page.sections = {hints(audit.summary),
                   conditions_list(conditions),
                   worst_contacts(audit),
                   kinds(audit.summary),
                   chart("Depth error", total.of(Column::depth_error)),
                   chart("Normal excess", total.of(Column::normal_excess)),
                   chart("Points off the surface", total.of(Column::point_error)),
                   refused_lines(audit.summary)};
  page.commands = {std::string(command)};
  return page;
}

}  // namespace pd::audit
