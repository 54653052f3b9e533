#include "protocol/stream/line_budget.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <optional>
#include <utility>

#include "protocol/line/bounded_line.hpp"
#include "protocol/line/line_source.hpp"

namespace pd::query {

namespace {

using Clock = std::chrono::steady_clock;

/// Bytes of address space that this process holds.
rlim_t held_bytes() {
  long pages = 0;
  if (std::FILE* const file = std::fopen("/proc/self/statm", "r")) {
    if (std::fscanf(file, "%ld", &pages) != 1) pages = 0;
    std::fclose(file);
  }
  return static_cast<rlim_t>(pages) * static_cast<rlim_t>(::sysconf(_SC_PAGESIZE));
}

void limit_memory(std::int64_t megabytes) {
  const rlim_t bytes = held_bytes() + (static_cast<rlim_t>(megabytes) << 20);
  const rlimit limit{bytes, bytes};
  (void)::setrlimit(RLIMIT_AS, &limit);
  const rlimit no_core{0, 0};
  (void)::setrlimit(RLIMIT_CORE, &no_core);
}

/// What the child writes into the pipe: the caller's id as soon as it is read, a newline, a letter for what the answer
/// says, the answer. A line holds no newline, so that an id holds none.
constexpr char kPlain = 'p', kUnreached = 'u', kLimitExceeded = 'l';

bool write_answer(int pipe, const LineAnswer& answer) {
  const char letter = answer.limit_exceeded ? kLimitExceeded : answer.unreached ? kUnreached : kPlain;
  return write_all(pipe, std::string(1, letter) + answer.text);
}

/// The child's life. @return whether the pipe holds a whole answer
bool answer_into(int pipe, std::string_view line, Session& session, Care care) {
  bool named = false;
  const auto name = [&](std::string_view id_text) { named = write_all(pipe, std::string(id_text) + "\n"); };
  if (care == Care::coarse) {
    const std::optional<LineAnswer> answer = answer_coarsely(line, session);
    return answer && write_all(pipe, "null\n") && write_answer(pipe, *answer);
  }
  const LineAnswer answer = answer_line(line, session, name);
  return (named || write_all(pipe, "null\n")) && write_answer(pipe, answer);
}

/// A child process that answers a line into a pipe. Ended, and waited for, at the latest by its destructor.
class Answering {
 public:
  Answering(std::string_view line, Session& session, const LineBudget& budget, Care care) {
    int ends[2] = {-1, -1};
    if (::pipe2(ends, O_CLOEXEC) != 0) return;
    process_ = ::fork();
    if (process_ == 0) {
      ::close(ends[0]);
      if (budget.megabytes > 0) limit_memory(budget.megabytes);
      bool whole = false;
      try {
        whole = answer_into(ends[1], line, session, care);
      } catch (...) {  // no memory for the words of a refusal: the parent has them
      }
      ::_exit(whole ? 0 : 1);
    }
    ::close(ends[1]);
    pipe_ = ends[0];
    if (process_ < 0) close_pipe();
  }
  Answering(const Answering&) = delete;
  Answering& operator=(const Answering&) = delete;
  ~Answering() {
    if (process_ > 0) {
      (void)::kill(process_, SIGKILL);
      (void)reap();
    }
    close_pipe();
  }

  [[nodiscard]] bool started() const { return pipe_ >= 0; }

  /// Gathers the answer until it is whole, or the time has come. True when the child has ended.
  bool gather(std::optional<Clock::time_point> until) {
    char buffer[1 << 16];
    while (pipe_ >= 0) {
      int wait = -1;
      if (until) {
        const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(*until - Clock::now()).count();
        wait = static_cast<int>(std::clamp<std::int64_t>(left + 1, 0, 1 << 30));
      }
      pollfd ready{pipe_, POLLIN, 0};
      const int found = ::poll(&ready, 1, wait);
      if (found < 0 && errno == EINTR) continue;
      if (found <= 0) return false;
      const ssize_t got = ::read(pipe_, buffer, sizeof buffer);
      if (got < 0 && errno == EINTR) continue;
      if (got > 0) {
        text_.append(buffer, static_cast<std::size_t>(got));
        continue;
      }
      close_pipe();
      whole_ = reap() == 0;
    }
    return true;
  }

  /// The caller's id, where the child has come so far.
  [[nodiscard]] std::optional<std::string_view> id_text() const {
    const std::size_t newline = text_.find('\n');
    if (newline == std::string::npos) return std::nullopt;
    return std::string_view(text_).substr(0, newline);
  }
  /// The answer, where the child has ended well.
  [[nodiscard]] std::optional<LineAnswer> answer() const {
    if (!whole_) return std::nullopt;
    const std::size_t letter = text_.find('\n') + 1;
    return LineAnswer{text_.substr(letter + 1), text_[letter] == kUnreached, text_[letter] == kLimitExceeded};
  }

 private:
  void close_pipe() {
    if (pipe_ >= 0) ::close(pipe_);
    pipe_ = -1;
  }
  int reap() {
    int status = -1;
    while (::waitpid(process_, &status, 0) < 0 && errno == EINTR) {
    }
    process_ = -1;
    return status;
  }

  pid_t process_ = -1;
  int pipe_ = -1;
  bool whole_ = false;
  std::string text_;
};

}  // namespace

LineAnswer answer_within(std::string_view line, Session& session, const LineBudget& budget) {
  const Clock::time_point start = Clock::now();
  const auto at = [&](double part) {
    return start +
           std::chrono::microseconds(static_cast<std::int64_t>(1000 * part * static_cast<double>(budget.milliseconds)));
  };
  Answering full(line, session, budget, Care::full);
  if (!full.started()) return refuse_line("null", "the system has no process left for this line");
  bool ended = full.gather(budget.milliseconds > 0 ? std::optional(at(0.5)) : std::nullopt);
  std::optional<LineAnswer> coarse;
  if (!ended) {
    Answering other(line, session, budget, Care::coarse);
    ended = full.gather(at(1));
    // What the coarse run has by now; it had half the time.
    if (!ended && other.gather(at(1))) coarse = other.answer();
  }
  if (ended) {
    if (auto answer = full.answer()) return *std::move(answer);
  }
  if (coarse) return *std::move(coarse);
  return refuse_line(full.id_text().value_or(id_of_line(line)),
                     ended ? "the process of this line ended before its answer"
                           : "not answered within " + std::to_string(budget.milliseconds) + " ms (--max-time)");
}

}  // namespace pd::query
