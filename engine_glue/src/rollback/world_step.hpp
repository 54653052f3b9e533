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

  /// Poses and velocities of kinematic bodies.
  static void save_kinematic_state(btDiscreteDynamicsWorld& world, btScalar step);
  /// The motion itself, and the world's actions, without tick callbacks. Forces, gravity among them, are the caller's,
  /// and stay.
  static void move(btDiscreteDynamicsWorld& world, btScalar step);

  static btAlignedObjectArray<btActionInterface*>& actions(btDiscreteDynamicsWorld& world) {
    return world.*(&WorldStep::m_actions);
  }
  static void call_actions(btDiscreteDynamicsWorld& world, btScalar step) {
    (world.*(&WorldStep::updateActions))(step);
  }

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
