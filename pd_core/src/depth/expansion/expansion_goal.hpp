/// @file
/// What an expanding polytope is asked for and what it answers: shared by the expansions on a surface in doubles
/// (expanding_polytope.hpp) and on an exact hull (expanding_hull.hpp).
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

#include "depth/difference/polytope_difference.hpp"
#include "pd/numeric/vector.hpp"

namespace pd::detail {

enum class ExpansionStatus : std::uint8_t {
  certified,   ///< 0 < lower <= depth <= upper, the bracket as narrow as asked
  separated,   ///< h_P(normal) < 0 for certain
  touching,    ///< |signed distance| is within what the goal takes for contact (smooth bodies)
  undecided,   ///< doubles cannot tell (touching, flat, or bracket not reached): exact arithmetic must
  over_budget  ///< too many nearly equal facets: the overlay is faster
};

struct ExpansionResult {
  ExpansionStatus status = ExpansionStatus::undecided;
  double lower = 0;  ///< -infinity when nothing is known
  double upper = std::numeric_limits<double>::infinity();
  Vec3 normal = Vec3::UnitX();                        ///< unit, of `upper` (or of the separating plane)
  int face = -1;                                      ///< nearest face of the polytope, if there was one
  DifferenceVertex separating{Vec3::Zero(), -1, -1};  ///< the vertex of P next to the separating plane, if there is one
};

/// `ExpansionGoal::close` of Bracket::contact: a thousandth of the depth.
inline constexpr double kContactClose = 1e-3;

struct ExpansionGoal {
  double relative = 0;        ///< stop when upper <= (1 + relative) lower
  double absolute = 0;        ///< or when upper - lower <= absolute times the largest |coordinate| seen
  double width = 0;           ///< or when upper - lower <= width
  double touching = 0;        ///< see ExpansionStatus::touching
  double touching_width = 0;  ///< the same, as a length
  int max_steps = std::numeric_limits<int>::max();
  /// After so many steps upper <= (1 + close) lower is enough: what a contact may leave open where more would cost it
  /// its bound.
  int close_after = std::numeric_limits<int>::max();
  double close = 0;
  /// `over_budget` once the upper bound falls below it (curved bodies).
  double upper_expected = -std::numeric_limits<double>::infinity();
  int vertices = 0;  ///< of both bodies, for ExpansionBudget; 0: given up after `max_steps` only
  /// `undecided` when a lower bound above `loss_from` falls by more than `max_loss`: the surface has lost its
  /// convexity.
  double max_loss = std::numeric_limits<double>::infinity();
  double loss_from = 0;
};

/// Whether a bracket is as narrow as asked; `largest` as in ExpansionGoal::absolute.
inline bool reached(const ExpansionGoal& goal, double lower, double upper, double largest) {
  return lower > 0 &&
         (upper - lower <= std::max(goal.absolute * largest, goal.width) || upper <= (1 + goal.relative) * lower);
}

/// Whether a bracket shows the bodies as touching, to within what was asked.
inline bool touches(const ExpansionGoal& goal, double lower, double upper, double largest) {
  const double limit = std::max(goal.touching * largest, goal.touching_width);
  return upper <= limit && lower >= -limit;
}

}  // namespace pd::detail
