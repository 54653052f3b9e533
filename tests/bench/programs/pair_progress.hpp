/// @file
/// What programs share that judge many pairs: a line of progress for each twentieth, and the work on several threads.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <cstdio>
#include <thread>
#include <vector>

namespace pd::bench {

/// Counts pairs that are done, on any thread.
class PairProgress {
 public:
  explicit PairProgress(std::int64_t pairs) : pairs_(pairs), step_(std::max<std::int64_t>(pairs / 20, 1)) {}

  void add(std::int64_t done) {
    const std::int64_t total = done_.fetch_add(done) + done;
    if (total / step_ == (total - done) / step_) return;
    std::fprintf(stderr, "%lld of %lld pairs\n", static_cast<long long>(total), static_cast<long long>(pairs_));
  }

 private:
  std::int64_t pairs_;
  std::int64_t step_;
  std::atomic<std::int64_t> done_ = 0;
};

/// Calls `work` on `threads` threads, this one among them, and waits for all.
template <class Work>
void on_threads(int threads, const Work& work) {
  std::vector<std::thread> others;
  for (int t = 1; t < threads; ++t) others.emplace_back(work);
  work();
  for (std::thread& t : others) t.join();
}

}  // namespace pd::bench
