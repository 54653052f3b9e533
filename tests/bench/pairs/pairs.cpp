#include "bench/pairs/pairs.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "bench/measure/allocation_counter.hpp"
#include "bench/measure/stopwatch.hpp"
#include "bench/pairs/judge.hpp"

namespace pd::bench {

void Tally::add(double ns, double allocations, double supports, bool wrong, double error) {
  times_.push_back(ns);
  allocations_ += allocations;
  supports_ += supports;
  wrong_ += wrong ? 1 : 0;
  worst_error_ = std::max(worst_error_, error);
}

Row Tally::row() const {
  Row row;
  row.pairs = count();
  row.p50_ns = quantile(times_, 0.5);
  row.p99_ns = quantile(times_, 0.99);
  row.max_ns = quantile(times_, 1);
  row.allocations = allocations_ / row.pairs;
  row.supports = supports_ / row.pairs;
  row.wrong = wrong_;
  row.worst_error = worst_error_;
  return row;
}

bool measure_draw(const Draw& draw, Solvers& solvers, double slow_ns, std::vector<char>& sits_out,
                  std::vector<Tally>& tallies) {
  const JudgedBodies bodies(draw.bodies);
  const Judge judge(bodies, draw.pose_a, draw.pose_b);
  if (judge.contact(Precision::binary64) != ContactClass::overlapping) return false;

  struct Lane {
    std::size_t solver;
    std::unique_ptr<Attempt> attempt;
    Plan plan;
    double least_ns = std::numeric_limits<double>::infinity();
    std::int64_t allocations = 0;
    std::int64_t calls = 0;
  };
  std::vector<Lane> lanes;
  int rounds = 0;
  for (std::size_t s = 0; s < solvers.size(); ++s) {
    if (sits_out[s] != 0 || !solvers[s]->takes(draw.bodies)) continue;
    Lane lane{s, solvers[s]->prepare(draw.bodies), {}};
    lane.attempt->stand(draw.pose_a, draw.pose_b);
    // The first run grows buffers and loads caches. One slow run may be the machine's doing, two are the solver's.
    for (int k = 0; k < 2; ++k) {
      const std::int64_t before = allocations();
      const auto t0 = Clock::now();
      lane.attempt->run();
      lane.least_ns = std::min(lane.least_ns, elapsed_ns(t0, Clock::now()));
      lane.allocations = allocations() - before;
    }
    lane.plan = plan_for(lane.least_ns);
    if (lane.least_ns > slow_ns) {
      sits_out[s] = 1;
      lane.plan.rounds = 0;
      lane.calls = 1;
    } else {
      lane.allocations = 0;
      lane.least_ns = std::numeric_limits<double>::infinity();
    }
    rounds = std::max(rounds, lane.plan.rounds);
    lanes.push_back(std::move(lane));
  }
  for (int round = 0; round < rounds; ++round) {
    for (Lane& lane : lanes) {
      if (round >= lane.plan.rounds) continue;
      lane.attempt->run();  // the others have had the caches in between
      const std::int64_t before = allocations();
      const auto t0 = Clock::now();
      for (int k = 0; k < lane.plan.calls; ++k) lane.attempt->run();
      const auto t1 = Clock::now();
      lane.allocations += allocations() - before;
      lane.calls += lane.plan.calls;
      lane.least_ns = std::min(lane.least_ns, elapsed_ns(t0, t1) / lane.plan.calls);
    }
  }
  for (const Lane& lane : lanes) {
    const Judgement j = judge.judge(lane.attempt->answer(), solvers[lane.solver]->precision());
    tallies[lane.solver].add(lane.least_ns, static_cast<double>(lane.allocations) / static_cast<double>(lane.calls),
                             lane.attempt->supports(), j.wrong, j.size_error);
  }
  return true;
}

std::vector<Row> rows_of(const Solvers& solvers, const std::vector<Tally>& tallies, std::string_view family,
                         int vertices, std::string_view depth, std::string_view baseline) {
  std::vector<Row> block;
  for (std::size_t s = 0; s < solvers.size(); ++s) {
    if (tallies[s].count() == 0) continue;
    Row row = tallies[s].row();
    row.family = family;
    row.vertices = vertices;
    row.depth = depth;
    row.solver = solvers[s]->name();
    block.push_back(std::move(row));
  }
  set_ratios(block, baseline);
  return block;
}

std::vector<Row> run_pairs(const PairsSettings& settings, Solvers& solvers) {
  std::vector<Row> rows;
  std::map<std::pair<std::string_view, scenes::DepthClass>, std::vector<char>> slow;
  print_header();
  for (const Cell& cell : settings.cells) {
    std::vector<Tally> tallies(solvers.size());
    std::vector<char>& sits_out = slow[{name_of(cell), cell.depth}];
    sits_out.resize(solvers.size(), 0);
    int refused = 0;
    std::uint64_t number = 0;
    for (int done = 0; done < settings.pairs && refused < 20 * settings.pairs;) {
      const std::optional<Draw> d = draw(cell, settings.seed, number++);
      const bool measured = d && measure_draw(*d, solvers, kSlowNs, sits_out, tallies);
      ++(measured ? done : refused);
    }
    const std::vector<Row> block =
        rows_of(solvers, tallies, name_of(cell), cell.vertices, scenes::to_string(cell.depth), kBulletEpa);
    print_rows(block);
    rows.insert(rows.end(), block.begin(), block.end());
  }
  return rows;
}

}  // namespace pd::bench
