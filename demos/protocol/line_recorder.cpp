#include "protocol/line_recorder.hpp"

#include <utility>

namespace pd::query {

LineRecorder::LineRecorder(RecordSettings settings) : settings_(std::move(settings)) {
  if (active()) file_.open(settings_.path, std::ios::binary | std::ios::app);
}

void LineRecorder::keep(std::string_view line, std::string_view answer, double milliseconds) {
  if (!active()) return;
  const bool every = settings_.above_milliseconds < 0 && !settings_.unreached;
  const bool slow = settings_.above_milliseconds >= 0 && milliseconds > settings_.above_milliseconds;
  // Strings of an answer are escaped: these words stand for themselves.
  const auto says = [&](std::string_view words) { return answer.find(words) != std::string_view::npos; };
  const bool unreached =
      settings_.unreached && (says("\"bracket_reached\":false") || says("\"code\":\"limit_exceeded\""));
  if (!every && !slow && !unreached) return;
  const std::scoped_lock lock(mutex_);
  file_ << line << '\n' << std::flush;
}

}  // namespace pd::query
