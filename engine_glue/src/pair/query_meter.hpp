/// @file
/// Counts a query by its class and, of one in so many, its time.
#pragma once

#include <chrono>

#include "pair/thread_buffers.hpp"
#include "pd/depth/depth_answer.hpp"

namespace pd::detail {

class QueryMeter {
 public:
  explicit QueryMeter(ThreadBuffers& held) : held_(held), sampled_(held.queries++ % kClockSample == 0) {
    if (sampled_) start_ = std::chrono::steady_clock::now();
  }

  /// The query is answered: it ends here.
  void count(ContactClass contact) {
    SolverCounters& counters = held_.counters;
    switch (contact) {
      case ContactClass::overlapping:
        counters.overlapping.add();
        break;
      case ContactClass::touching:
        counters.touching.add();
        break;
      case ContactClass::separated:
        counters.separated.add();
        break;
    }
    if (!sampled_) return;
    const auto spent = std::chrono::steady_clock::now() - start_;
    counters.nanoseconds.add(kClockSample * std::chrono::duration_cast<std::chrono::nanoseconds>(spent).count());
  }

 private:
  /// One query in this many reads the clock: two readings cost a tenth of a short query.
  static constexpr unsigned kClockSample = 16;

  ThreadBuffers& held_;
  bool sampled_;
  std::chrono::steady_clock::time_point start_{};
};

}  // namespace pd::detail
