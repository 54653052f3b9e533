#include "bench/pairs/standing.hpp"

#include <algorithm>

#include "bench/measure/allocation_counter.hpp"
#include "bench/measure/stopwatch.hpp"
#include "bench/pairs/judge.hpp"

namespace pd::bench {

namespace {

constexpr int kPasses = 5;
constexpr int kSideBySide = 8;
/// Of one call. A clock needs no help with what takes longer.
constexpr double kLongNs = 2e4;

struct Lane {
  std::vector<std::unique_ptr<Attempt>> attempts;
  std::vector<double> least_ns;
  std::int64_t allocations = 0;
  int side_by_side = kSideBySide;
};

}  // namespace

void measure_frames(const Bodies& bodies, const std::vector<Standing>& frames, Solvers& solvers,
                    const FrameJudge& error, std::vector<Tally>& tallies, const std::vector<char>& sits_out) {
  std::vector<char> taken;
  for (const auto& solver : solvers) taken.push_back(solver->takes(bodies) ? 1 : 0);
  const auto runs = [&](std::size_t s) { return taken[s] != 0 && (sits_out.empty() || sits_out[s] == 0); };
  std::vector<Lane> lanes(solvers.size());
  for (Lane& lane : lanes) lane.least_ns.assign(frames.size(), std::numeric_limits<double>::infinity());
  for (int pass = 0; pass < kPasses; ++pass) {
    for (std::size_t s = 0; s < solvers.size(); ++s) {
      if (!runs(s)) continue;
      lanes[s].attempts.clear();
      for (int k = 0; k < lanes[s].side_by_side; ++k) lanes[s].attempts.push_back(solvers[s]->prepare(bodies));
    }
    for (std::size_t i = 0; i < frames.size(); ++i) {
      for (std::size_t s = 0; s < solvers.size(); ++s) {
        if (!runs(s)) continue;
        Lane& lane = lanes[s];
        for (auto& attempt : lane.attempts) {
          attempt->stand(frames[i].a, frames[i].b);
          attempt->limit(frames[i].limit());
        }
        const std::int64_t before = allocations();
        const auto t0 = Clock::now();
        for (auto& attempt : lane.attempts) attempt->run();
        lane.least_ns[i] = std::min(lane.least_ns[i], elapsed_ns(t0, Clock::now()) / lane.side_by_side);
        lane.allocations = allocations() - before;
        if (i == 0 && lane.least_ns[0] > kLongNs) {
          lane.side_by_side = 1;
          lane.attempts.resize(1);
        }
        if (i == 0 || pass + 1 < kPasses) continue;
        const Attempt& last = *lane.attempts.front();
        const double off = error(last.answer(), frames[i], solvers[s]->precision());
        tallies[s].add(lane.least_ns[i], static_cast<double>(lane.allocations) / lane.side_by_side, last.supports(),
                       !(off <= kTolerance), off);
      }
    }
  }
}

}  // namespace pd::bench
