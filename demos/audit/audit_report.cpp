#include "audit/audit_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "audit/audit_answer.hpp"
#include "protocol/json_writer.hpp"

namespace pd::audit {

namespace {

constexpr const char* kStyle = R"(
:root{color-scheme:light dark;--ink:#1b1f24;--paper:#fff;--quiet:#5b6570;--line:#d5dae0;--bar:#2b6cb0;--bad:#b3261e;--good:#1f7a3d}
@media(prefers-color-scheme:dark){:root{--ink:#e6e9ee;--paper:#14171b;--quiet:#9aa5b1;--line:#343b44;--bar:#63a4e8;--bad:#ff8a80;--good:#6fd08c}}
body{margin:0 auto;padding:1rem;max-width:72rem;background:var(--paper);color:var(--ink);font:16px/1.5 system-ui,sans-serif}
h1{font-size:1.5rem;margin:.2rem 0}h2{font-size:1.15rem;margin:2rem 0 .5rem}p{margin:.4rem 0}.quiet{color:var(--quiet)}
.cards{display:grid;grid-template-columns:repeat(auto-fit,minmax(8.5rem,1fr));gap:.6rem;padding:0;margin:1rem 0;list-style:none}
.cards li{border:1px solid var(--line);border-radius:.5rem;padding:.6rem .8rem}.cards b{display:block;font-size:1.5rem}
.bad b,.fails{color:var(--bad)}.good b,.holds{color:var(--good)}
.scroll{overflow-x:auto}table{border-collapse:collapse;width:100%;font-size:.9rem;font-variant-numeric:tabular-nums}
th,td{padding:.25rem .5rem;text-align:right;border-bottom:1px solid var(--line);white-space:nowrap}
th:first-child,td:first-child{text-align:left}
svg{width:100%;min-width:40rem;height:auto;display:block}svg text{fill:var(--quiet);font:11px system-ui,sans-serif}
svg rect{fill:var(--bar)}svg line{stroke:var(--line)}
details{border:1px solid var(--line);border-radius:.5rem;padding:.4rem .8rem;margin:.4rem 0}summary{cursor:pointer}
pre{overflow-x:auto;white-space:pre-wrap;word-break:break-all;font-size:.8rem;margin:.4rem 0}
@media print{details{break-inside:avoid}.scroll{overflow:visible}}
)";

std::string short_number(double value) {
  if (value == 0) return "0";
  return value >= 1e-3 && value < 1e4 ? fmt::format("{:.3g}", value) : fmt::format("{:.1e}", value);
}

std::string card(std::string_view title, std::string_view value, std::string_view rank) {
  return fmt::format("<li class=\"{}\"><b>{}</b>{}</li>\n", rank, value, title);
}

std::string cards(const Audit& audit) {
  const Totals& total = audit.summary.total();
  const auto count = [](std::string_view title, std::int64_t n) {
    return card(title, fmt::format("{}", n), n == 0 ? "good" : "bad");
  };
  const ErrorQuantiles& depth = total.of(Column::depth_error);
  std::string text = "<ul class=\"cards\">\n";
  text += card("contacts judged", fmt::format("{}", total.judged), "");
  text += count("missed", total.missed) + count("phantom", total.phantom);
  text += count("not judged", total.unanswered + audit.summary.refused());
  text += card("depth error, p99", depth.count() > 0 ? short_number(depth.quantile(0.99)) : "-", "");
  text += card("depth error, largest", depth.count() > 0 ? short_number(depth.max()) : "-", "");
  return text + "</ul>\n";
}

std::string table_row(std::string_view kind, const Totals& totals) {
  std::string text = fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td>", xml_text(kind),
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
      "<h2>By kind of shapes</h2>\n<div class=\"scroll\" tabindex=\"0\"><table>\n<thead><tr><th>kind</th>"
      "<th>contacts</th><th>missed</th><th>phantom</th><th>no answer</th><th>depth error p99</th><th>max</th>"
      "<th>normal excess p99</th><th>max</th><th>points off p99</th><th>max</th></tr></thead>\n<tbody>\n";
  for (const auto& [kind, totals] : summary.by_kind()) text += table_row(kind, totals);
  text += table_row("all", summary.total());
  return text + "</tbody></table></div>\n";
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
      "<h2>{}</h2>\n<div class=\"scroll\" tabindex=\"0\"><svg viewBox=\"0 0 {} 170\" role=\"img\" aria-label=\"{}: "
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
  std::string text = "<h2>Worst contacts</h2>\n";
  for (const WorstContact& worst : audit.summary.worst()) {
    const SignedDepth x = worst_interval(worst, audit.tolerance);
    std::string what(worst.column);
    std::replace(what.begin(), what.end(), '_', ' ');
    text += fmt::format(
        "<details><summary>contact {}, line {}: {} {} ({})</summary>\n<p>Exact signed depth {:.17g} to {:.17g}; "
        "reported:</p>\n<pre>{}</pre>\n",
        xml_text(query::shortened(worst.contact.id_text, 40)), worst.line, what, short_number(worst.error),
        xml_text(kind_of(worst.contact)), x.lower, x.upper, xml_text(member_text(worst.text, "reported")));
    if (const std::string line = query_line(worst, audit.tolerance); !line.empty()) {
      text += fmt::format("<p>To ask again, for <code>pdepth query</code>:</p>\n<pre>{}</pre>\n", xml_text(line));
    }
    text += "</details>\n";
  }
  return text;
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

std::string refused_lines(const AuditSummary& summary) {
  if (summary.refused() == 0) return {};
  std::string text = fmt::format("<h2>Lines refused: {}</h2>\n<ul>\n", summary.refused());
  for (const RefusedLine& line : summary.refusals()) {
    text += fmt::format("<li>line {}: {}: {}</li>\n", line.line, xml_text(line.refusal.code),
                        xml_text(line.refusal.message));
  }
  return text + "</ul>\n";
}

}  // namespace

std::string xml_text(std::string_view text) {
  // The writer of JSON replaces what is no UTF-8.
  std::string clean;
  query::append_string(clean, text);
  clean = query::Json::parse(clean).get<std::string>();
  std::string result;
  for (const char c : clean) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += static_cast<unsigned char>(c) >= 0x20 || c == '\n' || c == '\t' ? c : '?';
    }
  }
  return result;
}

std::string audit_report(const Audit& audit, const std::vector<ConditionOutcome>& conditions, std::string_view record,
                         std::string_view command) {
  const std::string engine = xml_text(audit.header.engine);
  const Totals& total = audit.summary.total();
  std::string text =
      "<!DOCTYPE html>\n<html xmlns=\"http://www.w3.org/1999/xhtml\" lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n";
  text += fmt::format("<title>Contacts of {}</title>\n<style>{}</style>\n</head>\n<body>\n<main>\n", engine, kStyle);
  text += fmt::format(
      "<h1>Contacts of {}</h1>\n<p class=\"quiet\">{} ({}), judged against the exact answer; counts beyond {:g} of a "
      "pair's size.</p>\n",
      engine, xml_text(record), audit.header.single_precision ? "float32" : "float64", audit.tolerance);
  text += cards(audit) + conditions_list(conditions) + kinds(audit.summary);
  text += chart("Depth error", total.of(Column::depth_error));
  text += chart("Normal excess", total.of(Column::normal_excess));
  text += chart("Points off the surface", total.of(Column::point_error));
  text += worst_contacts(audit) + refused_lines(audit.summary);
  text += fmt::format("<h2>How to reproduce</h2>\n<pre>{}</pre>\n</main>\n</body>\n</html>\n", xml_text(command));
  return text;
}

}  // namespace pd::audit
