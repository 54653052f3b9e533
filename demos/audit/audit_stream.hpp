/// @file
/// A record read and judged, by one thread or by several: the same result, to the bit, with any number of them.
#pragma once

#include <functional>
#include <optional>

#include "audit/audit_summary.hpp"
#include "protocol/line/limits.hpp"

namespace pd::audit {

struct AuditSettings {
  query::Limits limits = {};
  int threads = 1;
  /// Relative to L; empty: 1e-6 for records in float32, 1e-12 for those in float64.
  std::optional<double> tolerance;
  std::size_t worst_kept = 0;
};

/// A contact as it leaves the judge, in the order of the lines.
using ContactSeen = std::function<void(const RecordedContact&, const Judgement&, std::int64_t line)>;

struct Audit {
  enum class End {
    read,        ///< to the end of the record
    unreadable,  ///< the input failed half way; errno says why
    no_record,   ///< the first line is no first line of a record that this reads: `summary.refusals()` says why
  };

  End end = End::read;
  RecordHeader header;
  double tolerance = 0;
  ShapeTable shapes;
  AuditSummary summary{0};
};

/// Reads lines from a file descriptor until its end. What is wrong with a line is kept with its number, and the rest is
/// judged. `audit.summary` refers to `audit.shapes`.
///
/// Memory: the shapes, a batch of some thousand lines or of a few megabytes, and what the summary holds.
/// @param seen  told of each contact; may be empty.
void audit_record(int input, const AuditSettings& settings, const ContactSeen& seen, Audit& audit);

}  // namespace pd::audit
