/// @file
/// An audit as a table, as JUnit, and contact by contact as comma-separated values.
#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "audit/audit_answer.hpp"
#include "protocol/line/json_writer.hpp"
#include "report/html_text.hpp"

namespace pd::audit {

namespace {

using report::short_number;

std::string quantile_or_dash(const ErrorQuantiles& errors, double share) {
  return errors.count() > 0 ? short_number(errors.quantile(share)) : "-";
}
std::string max_or_dash(const ErrorQuantiles& errors) { return errors.count() > 0 ? short_number(errors.max()) : "-"; }

std::string row(std::string_view kind, std::size_t kind_width, const Totals& totals) {
  const ErrorQuantiles& depth = totals.of(Column::depth_error);
  const ErrorQuantiles& normal = totals.of(Column::normal_excess);
  return fmt::format("{:<{}} {:>9} {:>7} {:>7} {:>6} |{:>8} {:>8} {:>8} |{:>8} {:>8} |{:>8}\n", kind, kind_width,
                     totals.contacts, totals.missed, totals.phantom, totals.unanswered, quantile_or_dash(depth, 0.5),
                     quantile_or_dash(depth, 0.99), max_or_dash(depth), quantile_or_dash(normal, 0.99),
                     max_or_dash(normal), max_or_dash(totals.of(Column::point_error)));
}

std::string said(const WorstContact& worst) {
  return worst.contact.report ? fmt::format("reported {:.9g}", worst.contact.report->depth) : "reported nothing";
}

/// "3 lines refused, 2 pairs without an answer".
std::string not_judged(const AuditSummary& summary) {
  return fmt::format("{} lines refused, {} pairs without an exact answer within the limits", summary.refused(),
                     summary.total().unanswered);
}

}  // namespace

std::vector<std::string> recorder_hints(const AuditSummary& summary) {
  const Totals& total = summary.total();
  std::vector<std::string> hints;
  if (2 * total.normals_turned > total.of(Column::normal_excess).count()) {
    hints.push_back(fmt::format(
        "{} of {} normals of overlapping pairs fit only when turned round: a record's normals point from B to "
        "A, the way A moves out",
        total.normals_turned, total.of(Column::normal_excess).count()));
  }
  if (2 * total.depths_turned > total.of(Column::depth_error).count()) {
    hints.push_back(fmt::format(
        "{} of {} depths fit only with the other sign: a record's depths are > 0 where bodies overlap, < 0 for a gap",
        total.depths_turned, total.of(Column::depth_error).count()));
  }
  return hints;
}

std::string audit_table(const Audit& audit, const std::vector<ConditionOutcome>& conditions, std::string_view record,
                        bool drawn) {
  const AuditSummary& summary = audit.summary;
  std::string text = fmt::format("record    {}  ({}, {})\n", record, audit.header.engine,
                                 audit.header.single_precision ? "float32" : "float64");
  text += fmt::format("contacts  {} judged of {}; errors relative to the pair's size, counts beyond {:g} of it\n\n",
                      summary.total().judged, summary.total().contacts + summary.refused_contacts(), audit.tolerance);
  std::size_t width = 9;
  for (const auto& [kind, totals] : summary.by_kind()) width = std::max(width, kind.size());
  text += fmt::format("{:<{}} {:>9} {:>7} {:>7} {:>6} |{:^26} |{:^17} |{:>8}\n", "", width, "", "", "", "no",
                      "depth error", "normal excess", "points");
  text += fmt::format("{:<{}} {:>9} {:>7} {:>7} {:>6} |{:>8} {:>8} {:>8} |{:>8} {:>8} |{:>8}\n", "kind", width,
                      "contacts", "missed", "phantom", "answer", "p50", "p99", "max", "p99", "max", "off by");
  for (const auto& [kind, totals] : summary.by_kind()) text += row(kind, width, totals);
  if (summary.by_kind().size() != 1) text += row("all", width, summary.total());
  if (!summary.worst().empty()) text += "\nworst\n";
  for (const WorstContact& worst : summary.worst()) {
    text +=
        fmt::format("  line {}  contact {}  {} {}  ({}, {})\n", worst.line, query::shortened(worst.contact.id_text, 40),
                    worst.column, short_number(worst.error), kind_of(worst.contact), said(worst));
  }
  if (!summary.worst().empty() && !drawn) {
    text += "  --report DIR draws them, with the line that asks for each again; --json has it, too\n";
  }
  for (const std::string& hint : recorder_hints(summary)) text += fmt::format("\nhint: {}\n", hint);
  if (!summary.all_judged()) text += fmt::format("\nnot judged: {}\n", not_judged(summary));
  if (!conditions.empty()) text += "\n";
  for (const ConditionOutcome& outcome : conditions) {
    text += fmt::format("{}  {} {:g}, allowed {:g}\n", outcome.holds ? "holds" : "FAILS", outcome.condition.name,
                        outcome.found, outcome.condition.limit);
  }
  return text;
}

std::string audit_junit(const Audit& audit, const std::vector<ConditionOutcome>& conditions, std::string_view record) {
  const bool whole = audit.summary.all_judged() && audit.end == Audit::End::read;
  const auto failures = std::count_if(conditions.begin(), conditions.end(),
                                      [](const ConditionOutcome& outcome) { return !outcome.holds; }) +
                        (whole ? 0 : 1);
  const std::string name = report::escaped(record);
  std::string text = fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuite name=\"pdepth audit {}\" tests=\"{}\" failures=\"{}\">\n",
      name, conditions.size() + 1, failures);
  text += fmt::format("  <testcase classname=\"{}\" name=\"all judged\"", name);
  if (whole) {
    text += "/>\n";
  } else {
    text +=
        fmt::format(">\n    <failure message=\"{}\"/>\n  </testcase>\n", report::escaped(not_judged(audit.summary)));
  }
  for (const ConditionOutcome& outcome : conditions) {
    text += fmt::format("  <testcase classname=\"{}\" name=\"{} &lt;= {:g}\"", name, outcome.condition.name,
                        outcome.condition.limit);
    text += outcome.holds ? "/>\n"
                          : fmt::format(">\n    <failure message=\"{} is {:g}, allowed {:g}\"/>\n  </testcase>\n",
                                        outcome.condition.name, outcome.found, outcome.condition.limit);
  }
  return text + "</testsuite>\n";
}

std::string csv_header() {
  std::string text = "line,contact,kind,answered,lower,upper,scale,reported_depth,missed,phantom";
  for (const Column column : kColumns) fmt::format_to(std::back_inserter(text), ",{}", to_string(column));
  return text + "\n";
}

std::string csv_row(const RecordedContact& contact, const Judgement& judgement, std::int64_t line) {
  std::string id = contact.id_text;
  if (id.find_first_of(",\"\n") != std::string::npos) {
    for (std::size_t at = 0; (at = id.find('"', at)) != std::string::npos; at += 2) id.insert(at, 1, '"');
    id = '"' + id + '"';
  }
  std::string text = fmt::format("{},{},{},{:d},{},{},{},", line, id, kind_of(contact), judgement.answered,
                                 judgement.lower, judgement.upper, judgement.scale);
  const auto out = std::back_inserter(text);
  if (contact.report) fmt::format_to(out, "{}", contact.report->depth);
  fmt::format_to(out, ",{:d},{:d}", judgement.missed, judgement.phantom);
  for (const Column column : kColumns) {
    text += ',';
    if (const auto& value = value_of(judgement, column)) fmt::format_to(out, "{}", *value);
  }
  return text + "\n";
}

}  // namespace pd::audit
