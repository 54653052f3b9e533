/// @file
/// Random moving pairs for the time of impact, by family, and the judgement of an answer about one.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "pd/contact/time_of_impact.hpp"
#include "pd/depth/scratch.hpp"

namespace pd::oracle {

/// The shapes are held on the heap: a pair may be moved.
struct MovingCase {
  std::string family;
  std::unique_ptr<ConvexShape> shape_a;
  std::unique_ptr<ConvexShape> shape_b;
  MovingShape a;
  MovingShape b;
  double duration = 1;
};

/// Pair number `index` of a seed: hulls thrown at each other, spinning rods beside a thin wall, fast small bodies and a
/// thin wall, grazing passes, parts that turn about a far point.
[[nodiscard]] MovingCase moving_case(std::uint64_t seed, std::uint64_t index);

struct ImpactJudgement {
  std::string complaint;  ///< empty where the answer holds
  bool reference_hit = false;
  bool graze = false;  ///< the library stopped at a gap within its tolerance, and the bodies never touch
  double lead = 0;     ///< the reference's time less the answer's; both hit
  TimeOfImpact answer;
};

/// Asks the library and the reference and compares. `resolution`: of the reference, as a share of the duration.
[[nodiscard]] ImpactJudgement judge(const MovingCase& pair, double tolerance, Scratch& scratch,
                                    double resolution = 1e-12);

}  // namespace pd::oracle
