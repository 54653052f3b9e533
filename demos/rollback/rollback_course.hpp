/// @file
/// What the demo rollback has found: impacts, and a row for every step.
#pragma once

#include <fmt/core.h>

#include <string>
#include <vector>

#include "pd/bullet/rollback.hpp"
#include "pd/contact/time_of_impact.hpp"
#include "support/demo_options.hpp"

namespace pd::demo {

/// When a method says that two bodies meet, and how deep they are by then.
struct Verdict {
  std::string method;
  bool hit = false;
  double time = 0;   ///< seconds since the step began
  double depth = 0;  ///< exact penetration at that time; negative: a gap
};

/// One impact: the two bodies at the start of the step in which they meet.
struct Impact {
  int a = -1;
  int b = -1;
  MovingShape moving_a;
  MovingShape moving_b;
  double step = 0;         ///< length of the step, seconds
  double plain_depth = 0;  ///< at the end of the plain step
  FirstContact contact;
  std::vector<Verdict> verdicts;
};

struct Course {
  std::vector<Impact> impacts;
  double deepest_plain = 0;
  double deepest_rollback = 0;
  int simulation_steps = 0;
  int steps = 0;
  bool replay_same_bits = true;
};

/// What was measured at the end of every step.
struct CourseRows {
  std::vector<double> times;
  std::vector<double> plain_depths;
  std::vector<double> rollback_depths;
  std::vector<double> plain_energies;
  std::vector<double> rollback_energies;
};

[[nodiscard]] inline std::string time_text(double seconds) { return fmt::format("{:.4f} ms", 1e3 * seconds); }

/// The two bodies of an impact where a plain step would have left them: a figure of a page. The bodies of the impact
/// must be alive.
[[nodiscard]] std::string plain_end_figure(const Impact& impact, std::size_t number);

/// Adds the course to `options.page`. @param figures  of `plain_end_figure`
void add_to_page(const Course& course, const CourseRows& rows, const std::vector<std::string>& figures,
                 const std::string& title, const DemoOptions& options);

}  // namespace pd::demo
