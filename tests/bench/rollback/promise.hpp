/// @file
/// What pairs of bodies are like after steps that end at first contact: the judge's findings, summed up and printed.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "engine_glue/pair_judge.hpp"

namespace pd::bench {

class Promise {
 public:
  /// Adds what the judge found after a step. Prints the pair, where it goes deeper than promised and `print_each`.
  void add(const std::vector<test::JudgedPair>& pairs, const std::vector<test::Passage>& passages, int scene, int step,
           bool print_each);
  void print() const;
  [[nodiscard]] bool broken() const { return broken_ > 0 || passages_ > 0; }

 private:
  /// Of depths: upper bounds of the bins; the last has none.
  static constexpr std::array<double, 7> kBins = {1e-6, 1e-5, 1e-4, 5e-4, 7.5e-4, 1e-3, 1e-2};
  struct Row {
    std::int64_t pairs = 0;
    std::array<std::int64_t, kBins.size() + 1> deeper{};  ///< above `rounding` and above how deep it was before
    std::int64_t broken = 0;
    std::int64_t run_in = 0;  ///< broken, in steps that reported a part of the least length
    double worst = 0;         ///< depth of a broken pair
    double worst_over = 0;    ///< above what is allowed
    double worst_run_in = 0;
    int scene = -1;
    int step = 0;
    int body_a = 0;
    int body_b = 0;
  };

  std::array<Row, test::kNumPairStarts> rows_;
  std::int64_t steps_ = 0;
  std::int64_t broken_ = 0;
  std::int64_t passages_ = 0;
  std::int64_t passages_bounded_ = 0;  ///< in steps whose cuts were used up
  double deepest_passage_ = 0;
};

}  // namespace pd::bench
