/// @file
/// `pdepth audit RECORD.jsonl`: an engine's contacts against the exact answer.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "audit/audit_answer.hpp"
#include "audit/audit_report.hpp"
#include "commands.hpp"
#include "line_input.hpp"

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
};

/// A file that is written while the audit goes on; closed and checked once.
class OutputFile {
 public:
  explicit OutputFile(const std::string& path) : file_(std::fopen(path.c_str(), "w")) {}
  ~OutputFile() {
    if (file_ != nullptr) std::fclose(file_);
  }
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  [[nodiscard]] bool is_open() const { return file_ != nullptr; }
  void write(const std::string& text) {
    if (file_ != nullptr) good_ = std::fwrite(text.data(), 1, text.size(), file_) == text.size() && good_;
  }
  /// False when it could not be opened, written or closed.
  [[nodiscard]] bool close() {
    if (!is_open()) return false;
    good_ = std::fclose(file_) == 0 && good_;
    file_ = nullptr;
    return good_;
  }

 private:
  std::FILE* file_;
  bool good_ = true;
};

void print_refusals(const std::string& record, const audit::AuditSummary& summary) {
  for (const audit::RefusedLine& line : summary.refusals()) {
    fmt::print(stderr, "pdepth: {}:{}: {}: {}{}\n", record, line.line, line.refusal.code, line.refusal.message,
               line.refusal.where.empty() ? "" : " at " + line.refusal.where);
  }
  const auto more = summary.refused() - static_cast<std::int64_t>(summary.refusals().size());
  if (more > 0) fmt::print(stderr, "pdepth: {}: {} more lines refused\n", record, more);
}

int cannot_write(const std::string& file) {
  fmt::print(stderr, "pdepth: {} cannot be written\n", file);
  return kFailed;
}

/// The command that gives the same page again.
std::string command_of(const AuditArguments& arguments) {
  std::string text = fmt::format("pdepth audit '{}' --worst {}", arguments.input, arguments.settings.worst_kept);
  if (arguments.tolerance > 0) text += fmt::format(" --tolerance {}", arguments.tolerance);
  if (!arguments.fail_on.empty()) text += fmt::format(" --fail-on {}", arguments.fail_on);
  return text + fmt::format(" --report '{}'    # pdepth {}", arguments.report, PDEPTH_VERSION);
}

/// The audit itself. @return a code other than kDone where there is nothing to report.
int read_record(const AuditArguments& arguments, audit::Audit& result) {
  const InputFile input(arguments.input);
  if (!input.good()) return cannot_read(arguments.input, errno);
  std::unique_ptr<OutputFile> csv;
  audit::ContactSeen seen;
  if (!arguments.csv.empty()) {
    csv = std::make_unique<OutputFile>(arguments.csv);
    if (!csv->is_open()) return cannot_write(arguments.csv);  // before an hour of judging, not after
    csv->write(audit::csv_header());
    seen = [&csv](const audit::RecordedContact& contact, const audit::Judgement& judgement, std::int64_t line) {
      csv->write(audit::csv_row(contact, judgement, line));
    };
  }
  errno = 0;
  audit::audit_record(input.descriptor(), arguments.settings, seen, result);
  const int reason = errno;
  print_refusals(arguments.input, result.summary);
  if (result.end == audit::Audit::End::unreadable) return cannot_read(arguments.input, reason);
  if (csv != nullptr && !csv->close()) return cannot_write(arguments.csv);
  return kDone;
}

int run_audit(AuditArguments arguments) {
  audit::AuditSettings& settings = arguments.settings;
  settings.threads = number_of_threads(settings.threads);
  if (arguments.tolerance > 0) settings.tolerance = arguments.tolerance;
  std::vector<audit::FailCondition> conditions;
  try {
    if (!arguments.fail_on.empty()) conditions = audit::parse_fail_conditions(arguments.fail_on);
  } catch (const query::Refusal& refusal) {
    fmt::print(stderr, "pdepth: {}\n", refusal.message);
    return kBadUsage;
  }
  audit::Audit result;
  if (const int code = read_record(arguments, result); code != kDone) return code;
  const auto outcomes = audit::check(conditions, result.summary);
  if (!arguments.junit.empty()) {
    OutputFile junit(arguments.junit);
    junit.write(audit::audit_junit(result, outcomes, arguments.input));
    if (!junit.close()) return cannot_write(arguments.junit);
  }
  if (result.end == audit::Audit::End::no_record) return kBadUsage;
  if (!arguments.report.empty()) {
    const report::Page page = audit::audit_report(result, outcomes, arguments.input, command_of(arguments));
    if (!report::write_page(arguments.report, page)) return cannot_write(arguments.report + "/report.html");
  }
  const std::string text = arguments.json ? audit::audit_json(result, outcomes) + "\n"
                                          : audit::audit_table(result, outcomes, arguments.input);
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0) {
    return cannot_write("the answer");
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
      ->check(CLI::Range(1e-15, 1.0));
  command->add_flag("--json", arguments->json, "One JSON object, for programs");
  command->add_option("--csv", arguments->csv, "Write a row for each contact to this file");
  command->add_option("--junit", arguments->junit, "Write the conditions as tests to this file");
  command->add_option("--report", arguments->report, "Write report.html, a page for people, into this folder");
  command->add_option("--fail-on", arguments->fail_on, "What is allowed, e.g. missed=0,phantom=0,depth_error=1e-4");
  command->add_option("--worst", settings.worst_kept, "Contacts to show, the worst first")
      ->check(CLI::Range(0, 10'000))
      ->capture_default_str();
  add_threads_option(*command, settings.threads, "judge");
  add_limit_options(*command, settings.limits);
  command->callback([arguments, &action] { action = [arguments] { return run_audit(*arguments); }; });
}

}  // namespace pd::cli
