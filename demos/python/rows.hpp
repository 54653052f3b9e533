/// @file
/// Rows of a batch on many threads, the interpreter's lock released.
#pragma once

#include <pybind11/pybind11.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "python/interpreter_lock.hpp"

namespace pd::python {

/// Hears Ctrl-C while the interpreter's lock is released: Python runs its handlers only where it is asked to.
class Interrupts {
 public:
  /// Requires the thread that released the lock. @throws what the handler of a signal raises (KeyboardInterrupt).
  void hear() {
    const auto now = std::chrono::steady_clock::now();
    if (now < next_) return;
    next_ = now + std::chrono::milliseconds(50);
    const Locked locked;
    if (PyErr_CheckSignals() != 0) throw pybind11::error_already_set();
  }

 private:
  std::chrono::steady_clock::time_point next_ = std::chrono::steady_clock::now() + std::chrono::milliseconds(50);
};

/// Calls `row(i, space)` for every i in [0, count), from `threads` threads; returns when all are done. `space_of()` is
/// a thread's own workspace. Requires that the interpreter's lock is released.
///
/// No order is promised between rows, so `row` writes to places of its own. Threads live as long as the call: a process
/// may fork between calls. The first exception thrown by a row is thrown here, and so is KeyboardInterrupt, once the
/// rows under way are done.
template <class SpaceOf, class Row>
void for_each_row(std::int64_t count, int threads, SpaceOf&& space_of, Row&& row) {
  std::atomic<std::int64_t> next{0};
  std::atomic<bool> stopped{false};
  std::mutex mutex;
  std::exception_ptr failure;
  // Small enough that the last piece keeps nobody waiting, large enough that taking one costs nothing.
  const std::int64_t piece = std::clamp<std::int64_t>(count / (8 * std::max(threads, 1)), 1, 64);
  const auto work = [&](Interrupts* interrupts) {
    try {
      auto&& space = space_of();
      for (;;) {
        const std::int64_t begin = next.fetch_add(piece);
        if (begin >= count) return;
        for (std::int64_t i = begin; i < std::min(begin + piece, count); ++i) {
          if (stopped.load(std::memory_order_relaxed)) return;
          row(i, space);
          if (interrupts != nullptr) interrupts->hear();
        }
      }
    } catch (...) {
      const std::scoped_lock lock(mutex);
      if (!failure) failure = std::current_exception();
      stopped = true;
    }
  };
  {
    std::vector<std::jthread> others;
    for (std::int64_t t = 1; t < std::min<std::int64_t>(threads, count); ++t) others.emplace_back(work, nullptr);
    Interrupts interrupts;
    work(&interrupts);
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace pd::python
