#include "audit/audit_stream.hpp"

#include <algorithm>
#include <atomic>
#include <new>
#include <thread>
#include <utility>

#include "protocol/line/bounded_line.hpp"
#include "protocol/line/line_source.hpp"

namespace pd::audit {

namespace {

constexpr std::size_t kBatchLines = 4096;
constexpr std::size_t kBatchBytes = std::size_t{4} << 20;

enum class LineKind : std::uint8_t { other, header, shape, contact };

/// A line on its way through a batch.
struct Line {
  std::int64_t number = 0;
  std::string text;
  query::ParsedLine parsed;
  LineKind kind = LineKind::other;
  std::optional<query::Refusal> refusal;
  RecordedShape shape;
  RecordedContact contact;
  Judgement judgement;
};

LineKind kind_of_line(const query::Json& object) {
  if (object.contains("contact")) return LineKind::contact;
  if (object.contains("shape")) return LineKind::shape;
  return object.contains("record") ? LineKind::header : LineKind::other;
}

/// Runs `work`, and keeps what it refuses.
template <class Work>
void refusing(Line& line, Work&& work) {
  if (line.refusal) return;
  try {
    work();
  } catch (query::Refusal& refusal) {
    line.refusal = std::move(refusal);
  } catch (const std::bad_alloc&) {
    line.refusal = query::Refusal{"limit_exceeded", "this line needs more memory than there is", ""};
  }
}

void parse(Line& line, const query::Limits& limits) {
  refusing(line, [&] {
    line.parsed = query::parse_line_within(line.text, limits.max_vertices);
    if (line.parsed.refusal) {
      line.refusal = std::move(line.parsed.refusal);
      // The reader's own words are those of another protocol.
      if (line.refusal->message.starts_with("a line must be one JSON object")) {
        line.refusal->message = "a line must be one JSON object with a \"shape\" or a \"contact\"";
      }
      return;
    }
    line.kind = kind_of_line(line.parsed.object);
    // Hulls are built here, on all threads; the table takes them in the order of the lines.
    if (line.kind == LineKind::shape) {
      line.shape = read_shape_line(query::Node(line.parsed.object), line.text, line.number, limits);
    }
  });
}

class RecordAuditor {
 public:
  RecordAuditor(const AuditSettings& settings, const ContactSeen& seen, Audit& audit)
      : settings_(settings), seen_(seen), audit_(audit), scratch_(static_cast<std::size_t>(settings.threads)) {}

  /// False when there is nothing more to read.
  bool take_batch(query::LineSource& source) {
    lines_.clear();
    std::size_t bytes = 0;
    std::string text;
    while (lines_.size() < kBatchLines && bytes < kBatchBytes) {
      const query::LineSource::Next next = source.next(text);
      if (next == query::LineSource::Next::failed) audit_.end = Audit::End::unreadable;
      if (next == query::LineSource::Next::failed || next == query::LineSource::Next::end) return false;
      ++line_number_;
      if (next == query::LineSource::Next::line && query::is_blank(text)) continue;
      Line& line = lines_.emplace_back();
      line.number = line_number_;
      if (next == query::LineSource::Next::oversized) {
        line.refusal = query::Refusal{
            "limit_exceeded",
            "the line is longer than " + std::to_string(settings_.limits.max_line) + " bytes (--max-line)", ""};
        continue;
      }
      bytes += text.size();
      line.text = std::move(text);
    }
    return true;
  }

  /// False when the record cannot be audited.
  bool work_batch() {
    each_line([&](Line& line, Scratch&) { parse(line, settings_.limits); });
    for (Line& line : lines_) {
      if (!has_header_) {
        if (!take_header(line)) return false;
      } else if (line.kind != LineKind::contact) {
        refusing(line, [&] { take_other(line); });
      }
    }
    each_line([&](Line& line, Scratch& scratch) {
      if (line.kind == LineKind::contact) {
        refusing(line, [&] {
          line.contact = read_contact(query::Node(line.parsed.object), line.text, line.number, audit_.shapes);
          line.judgement = judge(line.contact, audit_.tolerance, scratch);
        });
      }
      line.parsed = {};
    });
    for (const Line& line : lines_) {
      if (line.refusal) {
        audit_.summary.refuse(line.number, *line.refusal, line.kind == LineKind::contact);
      } else if (line.kind == LineKind::contact) {
        audit_.summary.add(line.contact, line.judgement, line.number, line.text);
        if (seen_) seen_(line.contact, line.judgement, line.number);
      }
    }
    return true;
  }

  [[nodiscard]] bool has_record() const { return has_header_; }

 private:
  /// The first line that is not blank.
  bool take_header(Line& line) {
    refusing(line, [&] {
      if (line.kind != LineKind::header) {
        query::refuse("missing_field", "a record begins with {\"record\":\"pdepth-contacts/1\",...}", "record");
      }
      audit_.header = read_header(query::Node(line.parsed.object));
      audit_.tolerance = settings_.tolerance.value_or(audit_.header.single_precision ? 1e-6 : 1e-12);
    });
    if (line.refusal) {
      audit_.summary.refuse(line.number, *line.refusal);
      audit_.end = Audit::End::no_record;
      return false;
    }
    has_header_ = true;
    return true;
  }

  void take_other(Line& line) {
    if (line.kind == LineKind::header) {
      query::refuse("bad_value", "the record has its first line already: audit one record at a time", "record");
    }
    if (line.kind == LineKind::other) {
      query::refuse("missing_field", "a line holds a \"shape\" or a \"contact\"", "");
    }
    audit_.shapes.define(query::Node(line.parsed.object), std::move(line.shape));
  }

  /// Calls `work(line, scratch)` for every line of the batch, on all threads.
  template <class Work>
  void each_line(Work&& work) {
    constexpr std::size_t kShare = 16;
    std::atomic<std::size_t> next{0};
    const auto run = [&](std::size_t thread) {
      for (std::size_t begin = next.fetch_add(kShare); begin < lines_.size(); begin = next.fetch_add(kShare)) {
        const std::size_t end = std::min(begin + kShare, lines_.size());
        for (std::size_t i = begin; i < end; ++i) work(lines_[i], scratch_[thread]);
      }
    };
    std::vector<std::jthread> threads;
    for (std::size_t t = 1; t < scratch_.size(); ++t) threads.emplace_back(run, t);
    run(0);
  }

  const AuditSettings& settings_;
  const ContactSeen& seen_;
  Audit& audit_;
  std::vector<Scratch> scratch_;
  std::vector<Line> lines_;
  std::int64_t line_number_ = 0;
  bool has_header_ = false;
};

}  // namespace

void audit_record(int input, const AuditSettings& settings, const ContactSeen& seen, Audit& audit) {
  audit.summary = AuditSummary(settings.worst_kept);
  query::LineSource source(input, settings.limits.max_line);
  RecordAuditor auditor(settings, seen, audit);
  for (bool more = true; more;) {
    more = auditor.take_batch(source);
    if (!auditor.work_batch()) return;
  }
  if (audit.end == Audit::End::read && !auditor.has_record()) {
    audit.summary.refuse(
        1, {"missing_field", "an empty record: it begins with {\"record\":\"pdepth-contacts/1\",...}", "record"});
    audit.end = Audit::End::no_record;
  }
}

}  // namespace pd::audit
