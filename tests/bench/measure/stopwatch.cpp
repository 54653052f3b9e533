#include "bench/measure/stopwatch.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pd::bench {

double clock_overhead_ns() {
  static const double overhead = [] {
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 2000; ++i) {
      const auto t0 = Clock::now();
      const auto t1 = Clock::now();
      least = std::min(least, std::chrono::duration<double, std::nano>(t1 - t0).count());
    }
    return least;
  }();
  return overhead;
}

double elapsed_ns(Clock::time_point begin, Clock::time_point end) {
  return std::max(0.0, std::chrono::duration<double, std::nano>(end - begin).count() - clock_overhead_ns());
}

double quantile(std::vector<double> values, double q) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto count = static_cast<double>(values.size());
  const auto rank = static_cast<std::ptrdiff_t>(std::clamp(std::ceil(q * count) - 1, 0.0, count - 1));
  std::nth_element(values.begin(), values.begin() + rank, values.end());
  return values[static_cast<std::size_t>(rank)];
}

double geometric_mean(const std::vector<double>& values) {
  double sum = 0;
  int count = 0;
  for (const double x : values) {
    if (!(x > 0) || !std::isfinite(x)) continue;
    sum += std::log(x);
    ++count;
  }
  return count > 0 ? std::exp(sum / count) : std::numeric_limits<double>::quiet_NaN();
}

Plan plan_for(double estimate_ns) {
  Plan plan;
  plan.calls = static_cast<int>(std::clamp(4000 / std::max(estimate_ns, 1.0), 1.0, 256.0));
  const double round = plan.calls * estimate_ns;
  plan.rounds = round < 1e5 ? 9 : round < 2e6 ? 5 : round < 2e7 ? 2 : 1;
  return plan;
}

}  // namespace pd::bench
