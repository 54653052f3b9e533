/// @file
/// `stack_growth`: what a step under `pd::StackSolver` costs as stacks grow: towers, pyramids, and the same boxes side
/// by side, at rest under recommended settings, beside Bullet's sweeps on the same contacts. Processor time, its growth
/// with the number of bodies fitted; factorisations a step, the dearest of the first steps, and how far bodies came
/// from where they stood (sweeps alone let tall towers fall, which makes steps cheap).
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "bench/measure/claims.hpp"
#include "bench/measure/processor_time.hpp"
#include "bench/measure/stopwatch.hpp"
#include "pd/bullet/solver_settings.hpp"
#include "scenes/bullet/bullet_scene.hpp"
#include "scenes/contact_worlds.hpp"

namespace {

struct Cost {
  double step_ms = 0;         ///< median over steps at rest
  double first_ms = 0;        ///< the dearest of the first ten
  double factorisations = 0;  ///< a step, at rest
  double unsettled = 0;       ///< share of groups, at rest
  double drift = 0;           ///< largest way of a body from its start, m
};

Cost cost_of(pd::scenes::World world, bool solved_at_once, int settle, int steps) {
  world.solved_at_once = solved_at_once;
  pd::scenes::BulletScene scene(world, pd::scenes::ContactRun::pdepth);
  pd::apply_recommended(scene.world().getSolverInfo());
  auto* const stacks = dynamic_cast<pd::StackSolver*>(scene.world().getConstraintSolver());
  Cost cost;
  std::vector<double> at_rest;
  for (int i = 0; i < settle + steps; ++i) {
    if (i == settle && stacks != nullptr) stacks->reset_statistics();
    const double begin = pd::bench::processor_seconds();
    scene.step(60);
    const double ms = 1e3 * (pd::bench::processor_seconds() - begin);
    if (i < 10) cost.first_ms = std::max(cost.first_ms, ms);
    if (i >= settle) at_rest.push_back(ms);
  }
  cost.step_ms = pd::bench::quantile(at_rest, 0.5);
  for (int i = 0; i < scene.num_bodies(); ++i) {
    const pd::Vec3& start = scene.plan(i).position;
    const btVector3 from(static_cast<btScalar>(start.x()), static_cast<btScalar>(start.y()),
                         static_cast<btScalar>(start.z()));
    const btVector3 way = scene.body(i).getWorldTransform().getOrigin() - from;
    cost.drift = std::max(cost.drift, static_cast<double>(way.length()));
  }
  if (stacks != nullptr) {
    const auto& counted = stacks->statistics();
    cost.factorisations = static_cast<double>(counted.factorisations) / steps;
    cost.unsettled =
        counted.groups > 0 ? static_cast<double>(counted.unsettled) / static_cast<double>(counted.groups) : 0;
  }
  return cost;
}

/// Boxes of a metre on the floor, none near another; up to 256.
pd::scenes::World side_by_side(int count) {
  pd::scenes::World world = pd::scenes::tower(count, 0.5, 0).world;
  int placed = 0;
  for (pd::scenes::WorldBody& body : world.bodies) {
    if (body.mass == 0) continue;
    body.position = pd::Vec3(1.25 * (placed % 16 - 7.5), 1.25 * (placed / 16 - 7.5), 0.5);
    ++placed;
  }
  return world;
}

pd::scenes::World stack(const std::string& family, int size) {
  if (family == "tower") return pd::scenes::tower(size, 0.5, 0).world;
  if (family == "pyramid") return pd::scenes::pyramid(size, 0).world;
  return side_by_side(size);
}

}  // namespace

int main(int argc, char** argv) {
  int settle = 120;
  int steps = 120;
  CLI::App app{"What a step under pd::StackSolver costs as stacks grow."};
  app.add_option("--settle", settle, "steps before those that are measured")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  app.add_option("--steps", steps, "steps measured")->check(CLI::PositiveNumber)->capture_default_str();
  CLI11_PARSE(app, argc, argv);

  struct Family {
    std::string name;
    std::vector<int> sizes;
  };
  const Family families[] = {
      {"tower", {5, 10, 20, 40, 80, 160}}, {"pyramid", {4, 6, 9, 14, 20, 29}}, {"apart", {5, 10, 20, 40, 80, 160}}};
  std::printf("%-9s %7s %10s %11s %15s %10s %10s %9s %9s\n", "stack", "bodies", "step, ms", "sweeps, ms",
              "factorisations", "unsettled", "first, ms", "drift, m", "sweeps'");
  for (const Family& family : families) {
    std::vector<double> bodies;
    std::vector<double> solved;
    std::vector<double> swept;
    for (const int size : family.sizes) {
      const pd::scenes::World world = stack(family.name, size);
      const auto count = std::count_if(world.bodies.begin(), world.bodies.end(),
                                       [](const pd::scenes::WorldBody& body) { return body.mass > 0; });
      const Cost ours = cost_of(world, true, settle, steps);
      const Cost sweeps = cost_of(world, false, settle, steps);
      std::printf("%-9s %7ld %10.4f %11.4f %15.2f %10.3f %10.3f %9.1e %9.1e\n", family.name.c_str(),
                  static_cast<long>(count), ours.step_ms, sweeps.step_ms, ours.factorisations, ours.unsettled,
                  ours.first_ms, ours.drift, sweeps.drift);
      bodies.push_back(static_cast<double>(count));
      solved.push_back(ours.step_ms);
      swept.push_back(sweeps.step_ms);
    }
    const pd::bench::PowerLaw law = pd::bench::fit_power_law(bodies, solved);
    const pd::bench::PowerLaw sweeps = pd::bench::fit_power_law(bodies, swept);
    std::printf("%-9s step ~ n^%.2f (%.2f to %.2f, the last two %.2f); sweeps ~ n^%.2f\n", family.name.c_str(),
                law.exponent, law.low, law.high, law.last, sweeps.exponent);
  }
  return 0;
}
