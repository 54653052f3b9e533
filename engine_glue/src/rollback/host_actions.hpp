/// @file
/// The host's actions (vehicles, character controllers), which Bullet calls at the end of every step: kept out of steps
/// that are tried, and called once for each step that counts.
///
/// Actions come before Bullet decides what falls asleep. So what it decided in the tried step is taken back, and
/// decided again after them: a world that nothing cuts is Bullet's own, bit for bit. (The sleep of multibodies is
/// decided before their actions: Bullet offers no access to the time that they have been at rest.)
#pragma once

#include <BulletDynamics/Dynamics/btActionInterface.h>
#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>

#include <vector>

namespace pd::detail {

/// Stands in for the host's actions while a step is tried, where it notes what Bullet has not decided yet.
class HostActions : private btActionInterface {
 public:
  /// While it lives, the world has this one action where it has any.
  class Aside {
   public:
    Aside(btDiscreteDynamicsWorld& world, HostActions& actions);
    ~Aside();
    Aside(const Aside&) = delete;
    Aside& operator=(const Aside&) = delete;

   private:
    btAlignedObjectArray<btActionInterface*>& present_;
    btAlignedObjectArray<btActionInterface*> saved_;
  };

  /// The step that was tried last, of length `step`, counts.
  void call(btDiscreteDynamicsWorld& world, btScalar step);

 private:
  struct Rest {
    btRigidBody* body;
    int activation_state;
    btScalar deactivation_time;
    btVector3 linear;
    btVector3 angular;
  };

  void updateAction(btCollisionWorld* world, btScalar step) override;
  void debugDraw(btIDebugDraw*) override {}

  std::vector<Rest> undecided_;
};

}  // namespace pd::detail
