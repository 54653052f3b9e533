/// @file
/// `pdepth audit RECORD.jsonl`: an engine's contacts against the exact answer.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "audit/audit_answer.hpp"
#include "audit/audit_report.hpp"
#include "commands.hpp"
#include "line_input.hpp"
#include "options.hpp"
#include "pd/numeric/whole_file.hpp"
#include "progress.hpp"
#include "report/page.hpp"
#include "support/complain.hpp"
#include "usage.hpp"

namespace pd::cli {

namespace {

constexpr const char* kAuditFooter = R"(A record: one JSON object a line, shapes before they are used:
  {"record":"pdepth-contacts/1","engine":"Bullet 3.24","scalar":"float32"}
  {"shape":"s1","is":{"type":"box","half_extents":[1,1,1]}}
  {"contact":7,"a":"s1","pose_a":POSE,"b":"s2","pose_b":POSE,
   "reported":null | {"depth":d,"normal":[x,y,z],"points":[{"position_a":[x,y,z],"position_b":[x,y,z]}]}}
depth > 0 overlaps, < 0 is a gap; the normal points from B to A. pd::ContactRecorder writes records of Bullet
worlds, pd_record.h those of any engine in C.

Columns: missed, phantom (counts beyond the tolerance); depth_error, normal_excess, point_error (relative to the
size L of the pair), depth_error_of_smaller, depth_error_absolute.

Exit codes: 0 all judged, 2 not all could be judged (or bad usage), 3 a condition of --fail-on does not hold.

Examples:
  pdepth audit contacts.jsonl
  pdepth audit contacts.jsonl --fail-on missed=0,phantom=0,depth_error=1e-4 --junit audit.xml
  pdepth audit contacts.jsonl --json --worst 20 | jq .worst)";

struct AuditArguments {
  std::string input;
  std::string csv;
  std::string junit;
  std::string fail_on;
  std::string report;  ///< a folder
  double tolerance = 0;
  audit::AuditSettings settings;
  bool json = false;
  bool force = false;
};

void print_refusals(const std::string& record, const audit::AuditSummary& summary) {
  for (const audit::RefusedLine& line : summary.refusals()) {
    complain("{}:{}: {}: {}{}", record, line.line, line.refusal.code, line.refusal.message,
             line.refusal.where.empty() ? "" : " at " + line.refusal.where);
  }
  const auto more = summary.refused() - static_cast<std::int64_t>(summary.refusals().size());
  if (more > 0) complain("{}: {} more lines refused", record, more);
}

/// The command that gives the same page again.
std::string command_of(const AuditArguments& arguments) {
  std::string text = fmt::format("pdepth audit '{}' --worst {}", arguments.input, arguments.settings.worst_kept);
  if (arguments.tolerance > 0) text += fmt::format(" --tolerance {}", arguments.tolerance);
  if (!arguments.fail_on.empty()) text += fmt::format(" --fail-on {}", arguments.fail_on);
  return text + fmt::format(" --report '{}'    # pdepth {}", arguments.report, report::program_version());
}

/// The audit itself. @return a code other than kDone where there is nothing to report.
int read_record(const AuditArguments& arguments, audit::Audit& result) {
  const InputFile input(arguments.input);
  if (!input.good()) return cannot_read(arguments.input, errno);
  for (const auto& [option, output] : {std::pair("--csv", &arguments.csv), std::pair("--junit", &arguments.junit)}) {
    if (!output->empty() && input.is_also(*output)) {
      query::refuse("bad_value", std::string(option) + ": " + *output + " is the record itself: write to another file",
                    "");
    }
  }
  std::unique_ptr<WholeFile> csv;
  audit::ContactSeen seen;
  if (!arguments.csv.empty()) {
    csv = std::make_unique<WholeFile>(arguments.csv);
    if (!csv->good()) return cannot_write({"--csv", arguments.csv});  // before an hour of judging, not after
    csv->write(audit::csv_header());
    seen = [&csv](const audit::RecordedContact& contact, const audit::Judgement& judgement, std::int64_t line) {
      csv->write(audit::csv_row(contact, judgement, line));
    };
  }
  Progress progress("audit " + arguments.input, [&input] { return share_read(input.descriptor()); });
  errno = 0;
  audit::audit_record(input.descriptor(), arguments.settings, seen, result);
  const int reason = errno;
  progress.end();
  print_refusals(arguments.input, result.summary);
  if (result.end == audit::Audit::End::unreadable) return cannot_read(arguments.input, reason);
  if (csv != nullptr && !csv->finish()) return cannot_write({"--csv", arguments.csv});
  return kDone;
}

int run_audit(AuditArguments arguments) {
  audit::AuditSettings& settings = arguments.settings;
  settings.threads = number_of_threads(settings.threads);
  check_outputs({}, {{"--csv", arguments.csv}, {"--junit", arguments.junit}});
  if (arguments.tolerance > 0) settings.tolerance = arguments.tolerance;
  std::vector<audit::FailCondition> conditions;
  if (!arguments.fail_on.empty()) conditions = audit::parse_fail_conditions(arguments.fail_on);
  if (const std::string words = report::foreign_page(arguments.report); !words.empty() && !arguments.force) {
    query::refuse("bad_value", "--report: " + words, "");
  }
  audit::Audit result;
  if (const int code = read_record(arguments, result); code != kDone) return code;
  const auto outcomes = audit::check(conditions, result.summary);
  if (!arguments.junit.empty() &&
      !write_whole_file(arguments.junit, audit::audit_junit(result, outcomes, arguments.input))) {
    return cannot_write({"--junit", arguments.junit});
  }
  if (result.end == audit::Audit::End::no_record) {
    complain("{} is no record of contacts: `pdepth audit --help` shows what one holds", arguments.input);
    return kBadUsage;
  }
  if (!arguments.report.empty()) {
    const report::Page page = audit::audit_report(result, outcomes, arguments.input, command_of(arguments));
    if (!report::write_page(arguments.report, page)) return cannot_write_page(arguments.report);
  }
  const std::string text =
      arguments.json
          ? audit::audit_json(result, outcomes) + "\n"
          : printable(audit::audit_table(result, outcomes, arguments.input, !arguments.report.empty()), "\n");
  fmt::print("{}", text);
  // Programs that read the JSON find the page's path where words for people go.
  if (!arguments.report.empty()) {
    fmt::print(arguments.json ? stderr : stdout, "\npage      {}/report.html\n", printable(arguments.report));
  }
  if (!std::all_of(outcomes.begin(), outcomes.end(), [](const auto& outcome) { return outcome.holds; })) {
    return kConditionFails;
  }
  return result.summary.all_judged() ? kDone : kBadUsage;
}

}  // namespace

void add_audit_command(CLI::App& app, Action& action) {
  auto arguments = std::make_shared<AuditArguments>();
  arguments->settings.threads = 0;
  arguments->settings.worst_kept = 5;
  audit::AuditSettings& settings = arguments->settings;
  CLI::App* command =
      app.add_subcommand("audit", "Judge the contacts that an engine recorded against the exact answer");
  command->footer(kAuditFooter);
  command->add_option("RECORD", arguments->input, "The record, JSON lines; - is standard input")->required();
  command
      ->add_option("--tolerance", arguments->tolerance,
                   "Relative to a pair's size; 1e-6 for float32 records and 1e-12 for float64 ones unless given")
      ->check(number_between(1e-15, 1.0));
  command->add_flag("--json", arguments->json, "One JSON object, for programs");
  command->add_option("--csv", arguments->csv, "Write a row for each contact to this file");
  command->add_option("--junit", arguments->junit, "Write the conditions as tests to this file");
  command->add_option("--report", arguments->report, "Write report.html, a page for people, into this folder");
  command->add_flag("--force", arguments->force, "Replace a report.html that pdepth did not write");
  command->add_option("--fail-on", arguments->fail_on, "What is allowed, e.g. missed=0,phantom=0,depth_error=1e-4");
  command->add_option("--worst", settings.worst_kept, "Contacts to show, the worst first")
      ->check(number_between(0, 10'000))
      ->capture_default_str();
  add_threads_option(*command, settings.threads, "judge");
  add_limit_options(*command, settings.limits);
  command->callback([arguments, &action] { action = [arguments] { return run_audit(*arguments); }; });
}

}  // namespace pd::cli
