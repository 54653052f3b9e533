#include "protocol/stream/line_recorder.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "protocol/line/line_source.hpp"

namespace pd::query {

namespace {

/// Held while a line is written or the file's end is looked at: a line that another program is about to write would
/// pass for one that was cut. Where a file system has no locks, lines are still written by one call each.
class FileLock {
 public:
  explicit FileLock(int file) : file_(file) {
    while (::flock(file_, LOCK_EX) != 0 && errno == EINTR) {
    }
  }
  ~FileLock() { ::flock(file_, LOCK_UN); }
  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;

 private:
  int file_;
};

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
  if (file_ < 0) {
    reason_ = errno;
    file_ = ::open(settings_.path.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC);  // a pipe, or not to be read
    if (file_ < 0) return;  // the first reason: this call makes no file
    reason_ = 0;
  }
  const FileLock lock(file_);
  if (ends_within_a_line(file_) && !write_all(file_, "\n")) reason_ = errno;
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
  if (!good()) return;
  const FileLock file_lock(file_);
  if (!write_all(file_, whole)) reason_ = errno;
}

}  // namespace pd::query
