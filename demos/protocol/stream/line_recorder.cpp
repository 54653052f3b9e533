#include "protocol/stream/line_recorder.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <utility>

#include "protocol/line/line_source.hpp"

namespace pd::query {

namespace {

bool ends_within_a_line(int file) {
  struct stat status {};
  char last = '\n';
  return ::fstat(file, &status) == 0 && status.st_size > 0 && ::pread(file, &last, 1, status.st_size - 1) == 1 &&
         last != '\n';
}

}  // namespace

LineRecorder::LineRecorder(RecordSettings settings) : settings_(std::move(settings)) {
  if (!active()) return;
  file_ = ::open(settings_.path.c_str(), O_RDWR | O_APPEND | O_CREAT | O_CLOEXEC, 0666);
  if (file_ < 0) file_ = ::open(settings_.path.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC);  // a pipe, or not to be read
  good_ = file_ >= 0 && (!ends_within_a_line(file_) || write_all(file_, "\n"));
}

LineRecorder::~LineRecorder() {
  if (file_ >= 0) ::close(file_);
}

void LineRecorder::keep(std::string_view line, const LineAnswer& answer, double milliseconds) {
  if (!active()) return;
  const bool every = settings_.above_milliseconds < 0 && !settings_.unreached;
  const bool slow = settings_.above_milliseconds >= 0 && milliseconds > settings_.above_milliseconds;
  const bool surprising = settings_.unreached && (answer.unreached || answer.limit_exceeded);
  if (!every && !slow && !surprising) return;
  const std::string whole = std::string(line) + '\n';
  const std::scoped_lock lock(mutex_);
  good_ = good_ && write_all(file_, whole);
}

}  // namespace pd::query
