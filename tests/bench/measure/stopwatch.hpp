/// @file
/// Times of short calls on a machine that is never quiet, and the order statistics that are made of them.
#pragma once

#include <algorithm>
#include <chrono>
#include <limits>
#include <vector>

namespace pd::bench {

using Clock = std::chrono::steady_clock;

/// Nanoseconds that reading the clock twice costs: the least of many readings, taken once.
[[nodiscard]] double clock_overhead_ns();

/// Nanoseconds between two readings, less the clock's own cost; at least 0.
[[nodiscard]] double elapsed_ns(Clock::time_point begin, Clock::time_point end);

/// Nanoseconds of a call over the items: the least mean of the rounds, each timed as a whole.
template <class Items, class Call>
[[nodiscard]] double least_mean_ns(const Items& items, int rounds, const Call& call) {
  double best = std::numeric_limits<double>::infinity();
  for (int round = 0; round < rounds; ++round) {
    const auto begin = Clock::now();
    for (const auto& item : items) call(item);
    best = std::min(best, elapsed_ns(begin, Clock::now()) / static_cast<double>(items.size()));
  }
  return best;
}

/// The value below which a share q in [0, 1] of the values lies (nearest rank). NaN where there are none.
[[nodiscard]] double quantile(std::vector<double> values, double q);

/// exp(mean(log x)) over the positive finite values; NaN where there are none.
[[nodiscard]] double geometric_mean(const std::vector<double>& values);

/// How often a task is run. The work is deterministic, so that whatever makes one round slower than another is
/// disturbance: the least mean of the rounds is the figure.
struct Plan {
  int calls = 1;   ///< in one round, back to back, so that the clock's step and cost vanish
  int rounds = 1;  ///< interleaved with the rounds of the other solvers
};

/// From the time of one call: rounds of some microseconds, many of them for short tasks and few for long ones.
[[nodiscard]] Plan plan_for(double estimate_ns);

}  // namespace pd::bench
