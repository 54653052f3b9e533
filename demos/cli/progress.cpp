#include "progress.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <string>
#include <string_view>
#include <utility>

#include "support/printable.hpp"

namespace pd::cli {

namespace {

using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kQuiet{500};
constexpr std::chrono::milliseconds kBetween{250};
constexpr std::string_view kClearLine = "\r\x1b[K";

/// Past stdio, whose lock a child process of `query --max-time` could inherit.
void write_to_terminal(std::string_view text) { (void)!::write(STDERR_FILENO, text.data(), text.size()); }

}  // namespace

Progress::Progress(std::string work, std::function<double()> share) : work_(std::move(work)), share_(std::move(share)) {
  if (::isatty(STDERR_FILENO) != 0) thread_ = std::thread([this] { show(); });
}

Progress::~Progress() { end(); }

void Progress::begin(std::string work) {
  const std::lock_guard lock(mutex_);
  work_ = std::move(work);
}

void Progress::end() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  ends_.notify_one();
  thread_.join();
}

void Progress::show() {
  const Clock::time_point start = Clock::now();
  std::unique_lock lock(mutex_);
  if (ends_.wait_for(lock, kQuiet, [this] { return ended_; })) return;
  do {
    const double share = share_ ? share_() : -1;
    const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(Clock::now() - start).count();
    const std::string done = share < 0 ? "" : fmt::format("  {:3.0f} %", 100 * std::min(share, 1.0));
    write_to_terminal(fmt::format("{}{}{}  {} s", kClearLine, printable(work_), done, seconds));
  } while (!ends_.wait_for(lock, kBetween, [this] { return ended_; }));
  write_to_terminal(kClearLine);
}

double share_read(int descriptor) {
  struct stat status {};
  if (::fstat(descriptor, &status) != 0 || !S_ISREG(status.st_mode) || status.st_size == 0) return -1;
  const off_t at = ::lseek(descriptor, 0, SEEK_CUR);
  return at < 0 ? -1 : static_cast<double>(at) / static_cast<double>(status.st_size);
}

}  // namespace pd::cli
