/// @file
/// Contact records for tests: written as text, audited by the library.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <memory>
#include <string>
#include <vector>

#include "audit/audit_stream.hpp"
#include "cli/temporary_folder.hpp"

namespace pd::test {

inline constexpr const char* kHeader = R"({"record":"pdepth-contacts/1","engine":"test","scalar":"float64"})";

/// A record's text, line by line.
class RecordText {
 public:
  explicit RecordText(const std::string& header = kHeader) { line(header); }
  /// Line breaks of the source become blanks.
  RecordText& line(const std::string& text) {
    for (const char c : text) text_ += c == '\n' ? ' ' : c;
    text_ += '\n';
    return *this;
  }
  RecordText& shape(const std::string& id, const std::string& shape) {
    return line(R"({"shape":")" + id + R"(","is":)" + shape + "}");
  }
  /// `more`: members between the shapes and "reported", such as poses, each with a comma in front.
  RecordText& contact(const std::string& a, const std::string& b, const std::string& more,
                      const std::string& reported) {
    return line(R"({"contact":)" + std::to_string(++contacts_) + R"(,"a":")" + a + R"(","b":")" + b + R"(")" + more +
                R"(,"reported":)" + reported + "}");
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_;
  int contacts_ = 0;
};

struct Audited {
  std::unique_ptr<audit::Audit> audit = std::make_unique<audit::Audit>();
  std::vector<audit::Judgement> judgements;  ///< in the order of the lines

  [[nodiscard]] const audit::Totals& total() const { return audit->summary.total(); }
  [[nodiscard]] double max(audit::Column column) const { return total().of(column).max(); }
};

inline Audited audit_file(const std::string& file, const audit::AuditSettings& settings = {}) {
  Audited result;
  const int input = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  EXPECT_GE(input, 0) << file;
  audit::audit_record(
      input, settings,
      [&](const audit::RecordedContact&, const audit::Judgement& judgement, std::int64_t) {
        result.judgements.push_back(judgement);
      },
      *result.audit);
  ::close(input);
  return result;
}

inline Audited audit_text(const std::string& text, const audit::AuditSettings& settings = {}) {
  const TemporaryFolder folder;
  return audit_file(folder.write("record.jsonl", text), settings);
}

}  // namespace pd::test
