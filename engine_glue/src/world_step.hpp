/// @file
/// One step of a Bullet world in its parts: what `stepSimulation(h, 0)` does, with the callbacks, the motion states and
/// the clearing of forces apart from the motion, so that a step can be tried before it counts.
#pragma once

#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>

namespace pd::detail {

/// Reaches members that Bullet offers to derived classes only; pointers to members keep calls virtual, so that worlds
/// with multibodies or of the host's own step as they do themselves.
class WorldStep : private btDiscreteDynamicsWorld {
 public:
  WorldStep() = delete;

  /// Velocities of kinematic bodies, gravity, the motion itself, without tick callbacks. Forces stay.
  static void move(btDiscreteDynamicsWorld& world, btScalar step);
  /// The same, where the caller has placed the kinematic bodies and given them their velocities.
  static void move_without_kinematics(btDiscreteDynamicsWorld& world, btScalar step);

  static void pre_tick(btDiscreteDynamicsWorld& world, btScalar step) {
    if (const btInternalTickCallback callback = world.*(&WorldStep::m_internalPreTickCallback)) callback(&world, step);
  }
  static void post_tick(btDiscreteDynamicsWorld& world, btScalar step) {
    if (const btInternalTickCallback callback = world.*(&WorldStep::m_internalTickCallback)) callback(&world, step);
  }

  /// Motion states at the present poses, moved on by `ahead` seconds (behind by `fixed - ahead` where the world
  /// interpolates with latency), as stepSimulation leaves them; `fixed` is 0 for steps of variable length.
  static void synchronize(btDiscreteDynamicsWorld& world, btScalar ahead, btScalar fixed);
};

}  // namespace pd::detail
