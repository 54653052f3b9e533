/// @file
/// The laws that random rooms are judged by: energy, and how deep pairs may be after a step.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "bench/rollback/promise.hpp"
#include "pd/bullet/rollback.hpp"

namespace pd::bench {

struct RoomSettings {
  int steps = 60;  ///< of 1/60 s
  RollbackSettings stepper;
  bool solved_at_once = false;  ///< constraints by `StackSolver`
  bool energy = true;           ///< false: the law of energy is not judged, which takes most of the time
  bool print_each = false;      ///< every pair that goes deeper than promised
};

/// What all scenes add up to.
struct Totals {
  int broken = 0;
  int lost = 0;
  int lost_plain = 0;
  long long parts = 0;
  long long trials = 0;
  long long contacts = 0;
  long long contact_trials = 0;
  int bounded = 0;
  int least_parts = 0;
  double deepest_run_in = 0;
  double worst = -HUGE_VAL;
  double seconds = 0;
  Promise promise;
  std::vector<int> with_trials = std::vector<int>(33);  ///< contacts that took so many
};

/// What one scene came to.
struct Outcome {
  double excess = 0;  ///< share of E_ref by which it breaks the law of energy (negative where it keeps it)
  int step = 0;       ///< when it was largest
  bool joint = false;
};

/// One scene under the stepper.
Outcome run_room(std::uint64_t seed, int scene, const RoomSettings& settings, Totals& totals);

void print(const Totals& totals, int scenes, int steps);

}  // namespace pd::bench
