/// @file
/// What a thread has computed: a busy machine's waiting does not count.
#pragma once

#include <ctime>

namespace pd::bench {

/// Processor time of this thread in seconds.
[[nodiscard]] inline double processor_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace pd::bench
