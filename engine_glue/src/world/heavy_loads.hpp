/// @file
/// Impulses with which light bodies carry heavy ones, found at the end of a step for the next one.
///
/// Bullet's solver makes a fixed number of sweeps. Where a body of mass M rests on one of mass m, a sweep moves no more
/// momentum to the heavy body than the light one takes up on its way to the ground, so that it mends m / M of the
/// missing load. Ten sweeps mend a twentieth of the load at M = 200 m, and the heavy body sinks. In the other
/// direction a single sweep does: an impulse that is too large for a light body which nothing holds is taken back at
/// once. So the next step's impulses are estimated from the bodies' velocities and from the forces that acted in this
/// step, by the same method that `StackSolver` uses, for the heavy bodies and what they touch only.
#pragma once

#include <LinearMath/btScalar.h>

class btDiscreteDynamicsWorld;

namespace pd::detail {

class SolverCore;

/// Notes the impulses in the pairs' memories, where the next step's contact points take them from. Does nothing in
/// worlds whose bodies' masses differ by less than thirty times. Time O(bodies), and O(contacts) where masses differ.
/// @param seconds  of the step that has ended
void carry_heavy_loads(btDiscreteDynamicsWorld& world, SolverCore& core, btScalar seconds);

}  // namespace pd::detail
