/// @file
/// `rollback_law`: random worlds stepped by pd::RollbackStepper, and two laws. Cutting steps adds no energy:
///
///     E(t) <= E(0) + max(0, gain of a plain run at 1,920 Hz) + 1e-3 E_ref at the end of every step,
///
/// with E_ref the kinetic energy at the start plus the range of the potential; and after every step no pair of bodies
/// is deeper than promised (`engine_glue/pair_judge.hpp`). Scene number i depends on --seed and i only: hulls, boxes
/// and compounds in a room, some in stacks or joined by constraints, restitution 0 to 1. Exit status 1 where a scene
/// breaks a law.
#include <CLI/CLI.hpp>
#include <cstdint>
#include <cstdio>

#include "bench/rollback/costs.hpp"
#include "bench/rollback/drops.hpp"
#include "bench/rollback/random_rooms.hpp"

int main(int argc, char** argv) {
  int scenes = 100;
  int first = 0;
  std::uint64_t seed = 1;
  pd::bench::RoomSettings settings;
  CLI::App app{"Random worlds under pd::RollbackStepper: no energy is gained, and no pair is deeper than promised."};
  app.add_option("--scenes", scenes)->capture_default_str();
  app.add_option("--first", first, "scene to begin with")->capture_default_str();
  app.add_option("--seed", seed)->capture_default_str();
  app.add_option("--steps", settings.steps, "of 1/60 s")->capture_default_str();
  bool cost = false;
  app.add_flag("--cost", cost,
               "only measures processor time: a pile of 64 boxes at rest, 50 balls at 30 m/s in a room");
  bool drop = false;
  app.add_flag("--drop", drop, "only drops a ball of restitution 1 from 1 m, for 10 s");
  bool bullets_flight = false;
  app.add_flag("--bullets-flight", bullets_flight, "without RollbackSettings::exact_flight");
  app.add_flag("--solved-at-once", settings.solved_at_once, "constraints by pd::StackSolver");
  bool depths_only = false;
  app.add_flag("--depths-only", depths_only, "the law of energy is not judged, which takes most of the time");
  app.add_flag("--print-each", settings.print_each, "every pair that goes deeper than promised");
  CLI11_PARSE(app, argc, argv);
  if (drop) {
    pd::bench::report_drops();
    return 0;
  }
  if (cost) {
    pd::bench::report_costs();
    return 0;
  }
  settings.stepper.exact_flight = !bullets_flight;
  settings.energy = !depths_only;
  pd::bench::Totals totals;
  for (int i = first; i < first + scenes; ++i) {
    const pd::bench::Outcome outcome =
        pd::bench::run_room(seed * 1000003 + static_cast<std::uint64_t>(i), i, settings, totals);
    if (outcome.excess <= 1e-3) continue;
    ++totals.broken;
    std::printf("BROKEN seed=%llu scene=%d, step %d%s: %.3g of E_ref above the law\n",
                static_cast<unsigned long long>(seed), i, outcome.step, outcome.joint ? ", with a joint" : "",
                outcome.excess);
  }
  pd::bench::print(totals, scenes, settings.steps);
  return totals.broken == 0 && !totals.promise.broken() ? 0 : 1;
}
