#include "protocol/line_budget.hpp"

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

#include "protocol/json_text.hpp"
#include "protocol/json_writer.hpp"

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

bool write_all(int descriptor, const std::string& text) {
  std::size_t done = 0;
  while (done < text.size()) {
    const ssize_t wrote = ::write(descriptor, text.data() + done, text.size() - done);
    if (wrote < 0 && errno == EINTR) continue;
    if (wrote <= 0) return false;
    done += static_cast<std::size_t>(wrote);
  }
  return true;
}

/// A child process that answers a line into a pipe. Ended, and waited for, at the latest by its destructor.
class Answering {
 public:
  Answering(std::string_view line, Session& session, const LineBudget& budget) {
    int ends[2] = {-1, -1};
    if (::pipe2(ends, O_CLOEXEC) != 0) return;
    process_ = ::fork();
    if (process_ == 0) {
      ::close(ends[0]);
      if (budget.megabytes > 0) limit_memory(budget.megabytes);
      ::_exit(write_all(ends[1], answer_line(line, session)) ? 0 : 1);
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
      whole_ = reap() == 0 && !text_.empty();
    }
    return true;
  }

  /// The answer, where the child has ended well.
  [[nodiscard]] std::optional<std::string> answer() const { return whole_ ? std::optional(text_) : std::nullopt; }

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

std::string refusal_text(std::string_view line, const std::string& message) {
  std::string out;
  JsonWriter writer(out);
  writer.begin_object().key("id").raw(parse_line(line).id_text).key("error").begin_object();
  writer.key("code").string("limit_exceeded").key("message").string(message).key("where").string("");
  writer.end_object().end_object();
  return out;
}

/// The same depth, coarsely: two rays of a grid tell more than nothing. Empty for other queries.
std::string coarse_line(std::string_view line) {
  Json query = Json::parse(line, nullptr, false);
  if (!query.is_object() || query.value("query", Json()) != "depth" || query.contains("metric")) return {};
  const auto convex = [&](const char* body) {
    const Json type = query.value(body, Json::object()).is_object() ? query[body].value("type", Json()) : Json();
    return type != "compound" && type != "star";
  };
  if (convex("a") && convex("b")) {
    query["method"] = "grid";
    query["delta"] = 0.5;
  } else {
    query["delta"] = 1;
  }
  return query.dump();
}

/// The coarse answer under the caller's id, its bracket said to be unreached; nothing where it is none.
std::optional<std::string> as_unreached(const std::string& answer) {
  constexpr std::string_view kBehind = ",\"translation\":";
  const std::size_t place = answer.find(kBehind);
  if (place == std::string::npos || answer.find("\"error\":{") < place) return std::nullopt;
  if (answer.find("\"bracket_reached\":") < place) return answer;
  return answer.substr(0, place) + ",\"bracket_reached\":false" + answer.substr(place);
}

}  // namespace

std::string answer_within(std::string_view line, Session& session, const LineBudget& budget) {
  const Clock::time_point start = Clock::now();
  const auto at = [&](double part) {
    return start +
           std::chrono::microseconds(static_cast<std::int64_t>(1000 * part * static_cast<double>(budget.milliseconds)));
  };
  Answering full(line, session, budget);
  if (!full.started()) return refusal_text(line, "the system has no process left for this line");
  bool ended = full.gather(budget.milliseconds > 0 ? std::optional(at(0.5)) : std::nullopt);
  std::optional<std::string> coarse;
  if (!ended) {
    const std::string roughly = coarse_line(line);
    std::optional<Answering> other;
    if (!roughly.empty()) other.emplace(roughly, session, budget);
    ended = full.gather(at(1));
    // What the coarse run has by now; it had half the time.
    if (!ended && other && other->gather(at(1)) && other->answer()) coarse = as_unreached(*other->answer());
  }
  if (ended && full.answer()) return *full.answer();
  if (coarse) return *coarse;
  return refusal_text(line, ended ? "the process of this line ended before its answer"
                                  : "not answered within " + std::to_string(budget.milliseconds) + " ms (--max-time)");
}

}  // namespace pd::query
