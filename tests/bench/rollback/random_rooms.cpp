#include "bench/rollback/random_rooms.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>

#include "engine_glue/pair_judge.hpp"
#include "engine_glue/random_room.hpp"

namespace pd::bench {

namespace {

/// The most that Bullet's own plain steps of 1/1920 s gain over the same time.
double plain_gain(std::uint64_t seed, int steps, double start, Totals& totals) {
  test::RandomRoom plain(seed);
  double gain = 0;
  for (int k = 0; k < steps * 32; ++k) {
    plain.world().stepSimulation(btScalar(1.0 / 1920), 0);
    gain = std::max(gain, plain.energy() - start);
  }
  totals.lost_plain += plain.lost();
  return gain;
}

}  // namespace

Outcome run_room(std::uint64_t seed, int scene, const RoomSettings& settings, Totals& totals) {
  test::RandomRoom guarded(seed, settings.solved_at_once);
  const double start = guarded.energy();
  const double reference = guarded.kinetic_energy() + guarded.potential_range();
  const double gain = settings.energy ? plain_gain(seed, settings.steps, start, totals) : HUGE_VAL;
  RollbackStepper stepper(guarded.world(), guarded.solver(), settings.stepper);
  test::PairJudge judge(guarded.world(), settings.stepper);
  double excess = -HUGE_VAL;
  int last = 0;
  for (int k = 0; k < settings.steps; ++k) {
    const auto clock = std::chrono::steady_clock::now();
    const RollbackReport report = stepper.step(btScalar(1.0 / 60));
    totals.seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - clock).count();
    totals.parts += report.parts;
    totals.trials += report.simulation_steps;
    totals.contacts += report.contacts.size();
    for (const FirstContact& contact : report.contacts) {
      totals.contact_trials += contact.trials;
      ++totals.with_trials[static_cast<std::size_t>(std::min(contact.trials, 32))];
    }
    totals.bounded += report.bounded ? 1 : 0;
    totals.least_parts += report.least_parts;
    totals.deepest_run_in = std::max(totals.deepest_run_in, report.deepest_run_in);
    const double over = guarded.energy() - start - gain;
    if (over > excess) {
      excess = over;
      last = k;
    }
    const std::vector<test::JudgedPair>& pairs = judge.judge(report);
    totals.promise.add(pairs, judge.passages(), scene, k, settings.print_each);
  }
  totals.lost += guarded.lost();
  totals.worst = std::max(totals.worst, excess / reference);
  return {excess / reference, last, guarded.has_joint()};
}

void print(const Totals& totals, int scenes, int steps) {
  const double frames = static_cast<double>(scenes) * steps;
  std::printf("%d scenes of %d steps", scenes, steps);
  if (totals.worst > -HUGE_VAL) {
    std::printf(": %d break the law of energy; worst %.3g of E_ref above E(0) and the plain gain (allowed 1e-3)",
                totals.broken, totals.worst);
  }
  std::printf("\n");
  std::printf("bodies lost: %d (plain at 1,920 Hz: %d)\n", totals.lost, totals.lost_plain);
  std::printf(
      "a step: %.3f parts, %.3f simulation steps, %.3f ms; %.2f trials a first contact\n",
      static_cast<double>(totals.parts) / frames, static_cast<double>(totals.trials) / frames,
      1e3 * totals.seconds / frames,
      totals.contacts > 0 ? static_cast<double>(totals.contact_trials) / static_cast<double>(totals.contacts) : 0.0);
  std::printf("trials a contact, share of contacts (of trials):");
  for (std::size_t k = 1; k < totals.with_trials.size(); ++k) {
    if (totals.with_trials[k] == 0) continue;
    const auto count = static_cast<double>(totals.with_trials[k]);
    std::printf(" %zu: %.3f (%.3f)", k, count / static_cast<double>(totals.contacts),
                static_cast<double>(k) * count / static_cast<double>(totals.contact_trials));
  }
  std::printf("\nleast parts %d, deepest run in %.2g m; bounded steps %d\n", totals.least_parts, totals.deepest_run_in,
              totals.bounded);
  totals.promise.print();
}

}  // namespace pd::bench
