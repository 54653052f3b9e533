/// @file
/// The impulse that a lasting point begins the next step with: what it carried, and half of the way on that it is
/// going.
///
/// Bullet's constraint solver starts from last step's impulses and takes a fixed number of sweeps. Through a tower of n
/// bodies a sweep mends about (pi / n)^2 / 4 of the slowest error, .6 % at n = 20, so that after thirty sweeps the
/// impulses are still those of some steps ago. A load that sways is answered late, and a late answer feeds the sway. A
/// guess that leads makes up for it. A tower of 20 at 60 Hz with the recommended settings falls after 29, 41, 59 and 54
/// s with shares of the trend of -.5, -.25, 0 and 1; with .25, .4, .5, .6 and .75 it stands and moves with 44, 40, 16,
/// 7 and 130 mm/s after a minute.
#pragma once

#include <LinearMath/btScalar.h>

#include <algorithm>
#include <utility>

namespace pd::detail {

/// Of a point that lasts, what it carried before. Negative: not known.
struct ImpulseTrend {
  btScalar carried = -1;  ///< at the end of the last step
  btScalar handed = -1;   ///< at its beginning
  btScalar ahead = -1;    ///< found for the next step already (heavy_loads.hpp)

  /// The point's impulse for the next step.
  /// @param solved    what it carries now, >= 0
  /// @param same_step whether the last step was as long as the next one: impulses are forces times steps
  btScalar next(btScalar solved, bool same_step) {
    const btScalar found = std::exchange(ahead, btScalar(-1));
    if (found >= 0 && same_step) {
      carried = solved;
      return handed = found;
    }
    // Nobody solved since: contacts were looked for twice in a step.
    if (solved == handed) return solved;
    constexpr btScalar kShare = btScalar(0.5);
    // A load that sways changes little in a step. What landed or came off is no trend: a column that lands would be
    // thrown up by half of the blow.
    constexpr btScalar kJump = 2;
    const bool sways = carried >= 0 && solved <= kJump * carried && carried <= kJump * solved;
    handed = same_step && sways ? std::max(btScalar(0), solved + kShare * (solved - carried)) : solved;
    carried = solved;
    return handed;
  }
};

}  // namespace pd::detail
