/// @file
/// A stream of lines answered in order, by one thread or by several.
#pragma once

#include "protocol/line/limits.hpp"
#include "protocol/stream/line_budget.hpp"
#include "protocol/stream/line_recorder.hpp"

namespace pd::query {

enum class StreamEnd {
  answered,    ///< every line has its answer
  unreadable,  ///< the input failed half way; what came before is answered
  unwritable,  ///< the answers cannot be written
  unrecorded,  ///< the record of lines cannot be written; errno says why
};

struct StreamSettings {
  Limits limits = {};
  int threads = 1;
  LineBudget budget = {};
  RecordSettings record = {};
};

/// Reads lines from `input` until its end and writes one answer a line to `output`, in the order of the lines.
///
/// Answers are flushed one by one where `input` or `output` is no regular file. Blank lines are skipped. Memory: the
/// lines being worked on hold `limits.max_line` bytes together, or are one line. Both are file descriptors, and stay
/// open.
[[nodiscard]] StreamEnd answer_stream(int input, int output, const StreamSettings& settings);

}  // namespace pd::query
