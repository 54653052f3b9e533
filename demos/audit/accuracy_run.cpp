#include "audit/accuracy_run.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <stdlib.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <optional>

#include "audit/audit_stream.hpp"
#include "audit/contact_figure.hpp"
#include "support/refusal.hpp"

namespace pd::audit {

namespace {

std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) {
    if (c == '\'') {
      result += "'\\''";
    } else {
      result += c;
    }
  }
  return result + "'";
}

/// What a command writes to its standard output; empty where it fails.
std::optional<std::string> output_of(const std::string& command) {
  std::FILE* pipe = ::popen(("ulimit -t " + std::to_string(kRecorderSeconds) + "; " + command).c_str(), "r");
  if (pipe == nullptr) return std::nullopt;
  std::string text;
  char buffer[4096];
  for (std::size_t got = 0; (got = std::fread(buffer, 1, sizeof(buffer), pipe)) > 0;) text.append(buffer, got);
  if (::pclose(pipe) != 0) return std::nullopt;
  return text;
}

/// A file for a record, gone with it.
class RecordFile {
 public:
  RecordFile() : path_(make_temporary_file("pdepth_record")) {}
  ~RecordFile() { ::unlink(path_.c_str()); }
  RecordFile(const RecordFile&) = delete;
  RecordFile& operator=(const RecordFile&) = delete;
  [[nodiscard]] const std::string& path() const { return path_; }

 private:
  std::string path_;
};

double error_of(const Judgement& judgement) {
  return std::max(std::abs(judgement.depth_error.value_or(0)), judgement.normal_excess.value_or(0));
}

void judge_record(const std::string& file, const AccuracySettings& settings, double draw_above,
                  const ContactJudge& judge, AccuracyRow& row) {
  const int input = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  row.failed = input < 0;
  if (row.failed) return;
  Audit audit;
  AuditSettings how;
  how.tolerance = settings.tolerance;
  how.threads = settings.threads;
  how.worst_kept = std::isfinite(draw_above) ? 1 : 0;
  audit_record(
      input, how,
      [&](const RecordedContact& contact, const Judgement& audited, std::int64_t) {
        const Judgement judgement = judge ? judge(contact) : audited;
        row.missed += judgement.missed ? 1 : 0;
        row.phantom += judgement.phantom ? 1 : 0;
        row.no_answer += judgement.answered ? 0 : 1;
        const double error = error_of(judgement);
        row.worst = std::max(row.worst, error);
        row.above_small += error > kSmallError ? 1 : 0;
        row.above_large += error > kLargeError ? 1 : 0;
        row.only_large += error > kLargeError && !judgement.missed && !judgement.phantom ? 1 : 0;
      },
      audit);
  ::close(input);
  row.failed = audit.end != Audit::End::read;
  const Totals& total = audit.summary.total();
  row.contacts = total.contacts + audit.summary.refused();
  row.no_answer += audit.summary.refused();
  for (const WorstContact& worst : audit.summary.worst()) {
    if (worst.error <= std::max(draw_above, kLargeError)) continue;
    row.figure = contact_figure(worst, settings.tolerance);
    row.figure->title = fmt::format("{}, {}: {}", row.engine, row.family, row.figure->title);
    row.figure->file_name = fmt::format("{}_{}_{}", row.engine, row.family, row.figure->file_name);
  }
}

}  // namespace

void AccuracyRow::add(const AccuracyRow& other) {
  failed = failed || other.failed;
  contacts += other.contacts;
  missed += other.missed;
  phantom += other.phantom;
  above_small += other.above_small;
  above_large += other.above_large;
  only_large += other.only_large;
  no_answer += other.no_answer;
  aborted += other.aborted;
  worst = std::max(worst, other.worst);
}

std::string make_temporary_file(const std::string& name) {
  std::error_code error;
  const std::filesystem::path folder = std::filesystem::temp_directory_path(error);
  if (error) query::refuse("unreadable_file", "TMPDIR names no folder for temporary files", "");
  std::string path = (folder / (name + "_XXXXXX")).string();
  const int descriptor = ::mkstemp(path.data());
  if (descriptor < 0) {
    query::refuse("unreadable_file",
                  fmt::format("{}: no temporary file can be made: {}", folder.string(), std::strerror(errno)), "");
  }
  ::close(descriptor);
  return path;
}

std::vector<std::string> engines_of(const std::string& program) {
  std::vector<std::string> engines;
  const std::string text = output_of("exec " + quoted(program) + " --list").value_or("");
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    if (end > at) engines.push_back(text.substr(at, end - at));
    at = end + 1;
  }
  return engines;
}

AccuracyRow run_accuracy(const std::string& program, const std::string& engine, const AccuracySource& source,
                         const AccuracySettings& settings, double draw_above, const ContactJudge& judge) {
  AccuracyRow row;
  row.engine = engine;
  row.family = source.family;
  const RecordFile file;
  const std::string pairs =
      source.cases.empty() ? " --family " + quoted(source.family) : " --cases " + quoted(source.cases);
  const auto text = output_of("exec " + quoted(program) + " --engine " + quoted(engine) + pairs + " --pairs " +
                              std::to_string(settings.pairs) + " --vertices " + std::to_string(settings.vertices) +
                              " --seed " + std::to_string(settings.seed) + " --out " + quoted(file.path()));
  row.failed = !text;
  if (row.failed) return row;
  // Nanoseconds a query and, from programs that survive that, how often the engine aborted: pairs without a line.
  char* rest = nullptr;
  row.nanoseconds = std::strtod(text->c_str(), &rest);
  row.aborted = std::max(0LL, std::strtoll(rest, nullptr, 10));
  judge_record(file.path(), settings, draw_above, judge, row);
  row.contacts += row.aborted;
  row.no_answer += row.aborted;
  return row;
}

}  // namespace pd::audit
