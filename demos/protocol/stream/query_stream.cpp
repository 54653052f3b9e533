#include "protocol/stream/query_stream.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "protocol/answer_line.hpp"
#include "protocol/line/json_text.hpp"
#include "protocol/line/line_source.hpp"

namespace pd::query {

namespace {

bool is_regular_file(int descriptor) {
  struct stat status {};
  return ::fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode);
}

/// Answers on their way out, gathered where nobody waits for them.
class AnswerSink {
 public:
  AnswerSink(int descriptor, bool flush_each) : descriptor_(descriptor), flush_each_(flush_each) {}

  /// False when the output cannot be written.
  bool write(const std::string& answer) {
    pending_ += answer;
    pending_ += '\n';
    return flush_each_ || pending_.size() >= kGathered ? flush() : true;
  }
  bool flush() {
    if (!write_all(descriptor_, pending_)) return false;
    pending_.clear();
    return true;
  }

 private:
  static constexpr std::size_t kGathered = std::size_t{1} << 16;
  int descriptor_;
  bool flush_each_;
  std::string pending_;
};

/// How each line is answered, and kept where that is asked for.
class Answerer {
 public:
  Answerer(const StreamSettings& settings, LineRecorder& recorder) : settings_(settings), recorder_(recorder) {}

  [[nodiscard]] Session session() const { return {.limits = settings_.limits}; }

  std::string operator()(const std::string& line, bool oversized, Session& session) const {
    if (oversized) return answer_oversized_line(session.limits).text;
    const auto start = std::chrono::steady_clock::now();
    LineAnswer answer =
        settings_.budget.bounded() ? answer_within(line, session, settings_.budget) : answer_line(line, session);
    const std::chrono::duration<double, std::milli> spent = std::chrono::steady_clock::now() - start;
    recorder_.keep(line, answer, spent.count());
    return std::move(answer.text);
  }

 private:
  const StreamSettings& settings_;
  LineRecorder& recorder_;
};

/// Lines in order, each with its answer once a worker has it. The reader waits at `admit` while too much is under way.
class OrderedWork {
 public:
  OrderedWork(std::size_t max_bytes, std::size_t max_lines) : max_bytes_(max_bytes), max_lines_(max_lines) {}

  /// Queues a line. False when the output has failed and nothing more is wanted.
  bool admit(std::string line, bool oversized) {
    std::unique_lock lock(mutex_);
    room_.wait(lock, [&] {
      return output_failed_ || (jobs_.empty() && bytes_ == 0) ||
             (bytes_ + line.size() <= max_bytes_ && jobs_.size() < max_lines_);
    });
    if (output_failed_) return false;
    bytes_ += line.size();
    jobs_.push_back(std::make_unique<Job>(Job{std::move(line), oversized, {}, false}));
    unstarted_.push_back(jobs_.back().get());
    work_.notify_one();
    return true;
  }

  void close() {
    const std::scoped_lock lock(mutex_);
    closed_ = true;
    work_.notify_all();
    answers_.notify_all();
  }

  /// A worker's life: answers lines until there are no more.
  void work(const Answerer& answerer) {
    Session session = answerer.session();
    for (;;) {
      Job* job = nullptr;
      {
        std::unique_lock lock(mutex_);
        work_.wait(lock, [&] { return !unstarted_.empty() || closed_; });
        if (unstarted_.empty()) return;
        job = unstarted_.front();
        unstarted_.pop_front();
      }
      std::string answer = answerer(job->line, job->oversized, session);
      const std::scoped_lock lock(mutex_);
      job->answer = std::move(answer);
      job->answered = true;
      if (jobs_.front().get() == job) answers_.notify_one();
    }
  }

  /// The writer's life: answers go out in the order of their lines.
  void write_all(AnswerSink& sink) {
    std::unique_lock lock(mutex_);
    for (;;) {
      answers_.wait(lock, [&] { return jobs_.empty() ? closed_ : jobs_.front()->answered; });
      if (jobs_.empty()) return;
      const std::unique_ptr<Job> job = std::move(jobs_.front());
      jobs_.pop_front();
      const bool failed_before = output_failed_;
      lock.unlock();
      const bool wrote = !failed_before && sink.write(job->answer);
      lock.lock();
      bytes_ -= job->line.size();
      if (!wrote) output_failed_ = true;
      room_.notify_one();
    }
  }

  [[nodiscard]] bool output_failed() const { return output_failed_; }

 private:
  struct Job {
    std::string line;
    bool oversized;
    std::string answer;
    bool answered;
  };

  const std::size_t max_bytes_;
  const std::size_t max_lines_;
  std::mutex mutex_;
  std::condition_variable room_, work_, answers_;
  std::deque<std::unique_ptr<Job>> jobs_;  ///< in the order of the lines
  std::deque<Job*> unstarted_;
  std::size_t bytes_ = 0;  ///< of the lines in jobs_ and of the one being written
  bool closed_ = false;
  bool output_failed_ = false;
};

StreamEnd answer_alone(LineSource& source, AnswerSink& sink, const Answerer& answerer) {
  Session session = answerer.session();
  std::string line;
  for (;;) {
    const LineSource::Next next = source.next(line);
    if (next == LineSource::Next::end) return StreamEnd::answered;
    if (next == LineSource::Next::failed) return StreamEnd::unreadable;
    if (next == LineSource::Next::line && is_blank(line)) continue;
    if (!sink.write(answerer(line, next == LineSource::Next::oversized, session))) return StreamEnd::unwritable;
  }
}

StreamEnd answer_together(LineSource& source, AnswerSink& sink, const Answerer& answerer,
                          const StreamSettings& settings) {
  constexpr std::size_t kLinesPerThread = 32;  // enough that no thread waits for a slow neighbour's turn
  OrderedWork work(settings.limits.max_line, kLinesPerThread * static_cast<std::size_t>(settings.threads));
  StreamEnd end = StreamEnd::answered;
  {
    std::vector<std::jthread> threads;
    for (int i = 0; i < settings.threads; ++i) threads.emplace_back([&] { work.work(answerer); });
    threads.emplace_back([&] { work.write_all(sink); });
    std::string line;
    for (;;) {
      const LineSource::Next next = source.next(line);
      if (next == LineSource::Next::failed) end = StreamEnd::unreadable;
      if (next == LineSource::Next::failed || next == LineSource::Next::end) break;
      if (next == LineSource::Next::line && is_blank(line)) continue;
      if (!work.admit(std::move(line), next == LineSource::Next::oversized)) break;
    }
    work.close();
  }
  return work.output_failed() ? StreamEnd::unwritable : end;
}

/// The recorder's own reason: another thread may have written, or another file since.
StreamEnd unrecorded(const LineRecorder& recorder) {
  errno = recorder.reason();
  return StreamEnd::unrecorded;
}

}  // namespace

StreamEnd answer_stream(int input, int output, const StreamSettings& settings) {
  LineSource source(input, settings.limits.max_line);
  AnswerSink sink(output, !is_regular_file(input) || !is_regular_file(output));
  LineRecorder recorder(settings.record);
  if (!recorder.good()) return unrecorded(recorder);
  const Answerer answerer(settings, recorder);
  const StreamEnd end =
      settings.threads > 1 ? answer_together(source, sink, answerer, settings) : answer_alone(source, sink, answerer);
  if (!sink.flush()) return StreamEnd::unwritable;
  return recorder.good() ? end : unrecorded(recorder);
}

}  // namespace pd::query
