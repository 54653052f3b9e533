/// @file
/// The turning of a rigid body that nothing turns: Euler's equations without torque.
///
/// The kinetic energy splits into those of the three principal axes, and the motion of each alone is a turn about that
/// axis at the rate L_i / I_i, during which the body's angular momentum L, in the frame of the body, turns back. Their
/// product in symmetric order is a step of second order, three such steps of the lengths w, 1 - 2 w and w with
/// w = 1 / (2 - 2^(1/3)) one of fourth order. Every factor is a rotation, so that the angular momentum in the world is
/// kept up to rounding whatever the length; the energy swings about its value and does not drift.
///
/// J. Touma, J. Wisdom, "Lie-Poisson integrators for rigid body dynamics in the solar system", 1994; the composition:
/// H. Yoshida, "Construction of higher order symplectic integrators", 1990.
#pragma once

#include "pd/numeric/vector.hpp"

namespace pd::detail {

struct Rotation {
  Mat3 orientation;       ///< from the frame of the principal axes to the world
  Vec3 angular_velocity;  ///< in the world, radians per unit of time
};

/// Where the body is after `duration` >= 0, and how it turns then. `inertia`: about the principal axes, all > 0. The
/// kinetic energy stays to 5e-7 of it (`free_rotation_test.cpp`). Time: one substep of nine turns for each .04
/// rad.
[[nodiscard]] Rotation rotate_freely(const Rotation& start, const Vec3& inertia, double duration);

}  // namespace pd::detail
