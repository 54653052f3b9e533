#include "bench/rollback/promise.hpp"

#include <algorithm>
#include <cstdio>

namespace pd::bench {

namespace {

constexpr std::array<const char*, test::kNumPairStarts> kNames = {"apart", "apart, met in the step", "in contact"};

}  // namespace

void Promise::add(const std::vector<test::JudgedPair>& pairs, const std::vector<test::Passage>& passages, int scene,
                  int step, bool print_each) {
  ++steps_;
  for (const test::JudgedPair& pair : pairs) {
    Row& row = rows_[static_cast<std::size_t>(pair.start)];
    ++row.pairs;
    const double gained = pair.depth() - std::max(0.0, -pair.before);
    if (pair.depth() <= pair.rounding || gained <= 0) continue;
    const auto bin = std::lower_bound(kBins.begin(), kBins.end(), gained);
    ++row.deeper[static_cast<std::size_t>(bin - kBins.begin())];
    if (!pair.broken()) continue;
    const double over = pair.depth() - pair.allowed;
    if (print_each) {
      std::printf("DEEP scene=%d step=%d bodies %d and %d, %s%s: from %.3g to %.3g (allowed %.3g)\n", scene, step,
                  pair.a->getWorldArrayIndex(), pair.b->getWorldArrayIndex(),
                  kNames[static_cast<std::size_t>(pair.start)], pair.run_in ? ", run in" : "", pair.before, pair.after,
                  -pair.allowed);
    }
    if (pair.run_in) {
      ++row.run_in;
      row.worst_run_in = std::max(row.worst_run_in, pair.depth());
      continue;
    }
    ++row.broken;
    ++broken_;
    if (over <= row.worst_over) continue;
    row.worst_over = over;
    row.worst = pair.depth();
    row.scene = scene;
    row.step = step;
    row.body_a = pair.a->getWorldArrayIndex();
    row.body_b = pair.b->getWorldArrayIndex();
  }
  for (const test::Passage& passage : passages) {
    (passage.bounded ? passages_bounded_ : passages_) += 1;
    deepest_passage_ = std::max(deepest_passage_, passage.depth);
    if (passage.bounded && !print_each) continue;
    std::printf("PASSED THROUGH%s scene=%d step=%d bodies %d and %d: %.3g deep on the way\n",
                passage.bounded ? ", cuts used up," : "", scene, step, passage.a->getWorldArrayIndex(),
                passage.b->getWorldArrayIndex(), passage.depth);
  }
}

void Promise::print() const {
  std::printf("\npairs after %lld steps, by how they came into the step:\n", static_cast<long long>(steps_));
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    const Row& row = rows_[i];
    std::printf("  %-24s %10lld pairs; broken %lld", kNames[i], static_cast<long long>(row.pairs),
                static_cast<long long>(row.broken));
    if (row.broken > 0) {
      std::printf(" (worst %.3g m, %.3g more than allowed: scene %d, step %d, bodies %d and %d)", row.worst,
                  row.worst_over, row.scene, row.step, row.body_a, row.body_b);
    }
    if (row.run_in > 0) {
      std::printf("; deeper in steps that reported run-ins %lld (worst %.3g m)", static_cast<long long>(row.run_in),
                  row.worst_run_in);
    }
    std::printf("\n    deepened beyond rounding, to");
    for (std::size_t k = 0; k < kBins.size(); ++k) {
      std::printf(" %.2g: %lld,", kBins[k], static_cast<long long>(row.deeper[k]));
    }
    std::printf(" more: %lld\n", static_cast<long long>(row.deeper[kBins.size()]));
  }
  std::printf(
      "  passed through each other within a part: %lld, and %lld in steps whose cuts were used up (deepest %.3g m)\n",
      static_cast<long long>(passages_), static_cast<long long>(passages_bounded_), deepest_passage_);
}

}  // namespace pd::bench
