/// @file
/// One line within a budget of time and memory: in a process of its own, which ends when the budget does.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "protocol/answer_line.hpp"

namespace pd::query {

struct LineBudget {
  std::int64_t milliseconds = 0;  ///< `--max-time`; 0: no bound
  std::int64_t megabytes = 0;     ///< `--max-memory`, beyond what the program holds before the line; 0: no bound

  [[nodiscard]] bool bounded() const { return milliseconds > 0 || megabytes > 0; }
};

/// Answers a line as `answer_line` does, within the budget: reading it counts, too, and happens in the line's process
/// alone. A depth that is not ready by then is answered by the
/// certified bracket of a coarse run that starts at half the time, with "bracket_reached": false; every other line by
/// limit_exceeded. A line that brings its process down is answered so, too. Costs two processes at most, about a
/// millisecond each.
[[nodiscard]] LineAnswer answer_within(std::string_view line, Session& session, const LineBudget& budget);

}  // namespace pd::query
