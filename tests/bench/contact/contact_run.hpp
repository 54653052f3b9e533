/// @file
/// One scene under several ways to find contacts, stepped in turns, with measurements that none of them makes for
/// itself: penetration is measured by pd_core on the true poses of the outer, sharp shapes.
#pragma once

#include <memory>
#include <vector>

#include "scenes/bullet/bullet_scene.hpp"
#include "scenes/contact_worlds.hpp"

namespace pd::bench {

struct ContactSetting {
  scenes::ContactRun run = scenes::ContactRun::pdepth;
  double steps_per_second = 60;
  bool recommended = false;  ///< `pd::apply_recommended`, else Bullet's defaults
  bool stacks = false;       ///< `pd::StackSolver`, else Bullet's sequential impulses
  int iterations = 0;        ///< of the constraint solver; 0: as those have it
};

/// What a run shows. Lengths in units of the scene's body size unless they say metres.
struct ContactFigures {
  double step_p50_ms = 0;  ///< over steps, of each step's median over starts (`quantiles_of_steps`)
  double step_p99_ms = 0;
  double step_max_ms = 0;
  double query_ns = 0;       ///< median over steps of the mean nanoseconds a depth query (ours; 0 for Bullet's)
  double deepest = 0;        ///< largest exact penetration, sampled 30 times a second
  double deepest_late = 0;   ///< the same over the last quarter
  double drift = 0;          ///< largest way of a body from its start
  double fall_seconds = 0;   ///< when a body was half a size away from its start; the whole time where none was
  double tail_speed = 0;     ///< mean over the last tenth of the fastest body's speed; m/s
  double final_speed = 0;    ///< of the first moving body along x at the end; m/s
  double bounce_error = 0;   ///< rebound: of the height that the first bounce keeps, over what it should be; largest
  double toppled = 0;        ///< share of the moving bodies that end half a size aside of where they started
  double energy_gained = 0;  ///< largest excess over the start, in units of m g size of all bodies
  double contacts = 0;       ///< mean over the last quarter
  double new_points = 0;     ///< share of points younger than two steps, over the last quarter
  double lost = 0;           ///< bodies below the ground or far away at the end
  double queries = 0;        ///< asked of our solver
  double exact_signs = 0;    ///< decisions in them that exact arithmetic took
  double wider = 0;          ///< answers with a bracket wider than the poses deserve
};

/// What one start shows, but for the quantiles of its steps, and how long each step took.
struct ContactStart {
  ContactFigures figures;
  std::vector<double> step_ms;
};

/// Sets the quantiles of `figures` from the times of several starts. The starts differ by a millionth of a body, so
/// that a step costs them all the same; what the machine adds to one of them (a timer's tick is 50 us, ten steps of a
/// single body) is not the step's own. Each step is therefore the median of the starts that reach it.
void quantiles_of_steps(const std::vector<ContactStart>& starts, ContactFigures& figures);

/// Runs the scene under every setting for `seconds`; settings share a step length. A scene whose goal is to stand ends
/// for a setting when it has fallen. Steps are made in turns, so that disturbances of the machine meet all alike.
[[nodiscard]] std::vector<ContactStart> run_contact_scene(const scenes::ContactScene& scene,
                                                          const std::vector<ContactSetting>& settings, double seconds);

}  // namespace pd::bench
