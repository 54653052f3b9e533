/// @file
/// The part of a snapshot that Featherstone multibodies are: base, joints, velocities, forces, what their constraints
/// remember.
#pragma once

#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>

#include <vector>

namespace pd::detail {

class MultiBodyState {
 public:
  /// Saves every multibody of the world; none where it is no btMultiBodyDynamicsWorld.
  void save(btDiscreteDynamicsWorld& world);
  /// True if the world still has the saved multibodies, links and constraints.
  [[nodiscard]] bool same(btDiscreteDynamicsWorld& world) const;
  /// Brings them back, the transforms of their colliders included. Bullet offers no access to the time that a multibody
  /// has been at rest: after `restore` it may fall asleep by the steps taken back earlier.
  void restore() const;

 private:
  struct Link {
    btScalar position[7];
    btScalar torque[6];
    btVector3 force;
    btVector3 moment;
  };
  struct Body {
    btMultiBody* body;
    btVector3 position;
    btQuaternion rotation;
    btVector3 force;
    btVector3 torque;
    bool awake;
    std::vector<btScalar> velocities;
    std::vector<Link> links;
  };
  struct Impulse {
    btMultiBodyConstraint* constraint;
    int row;
    btScalar impulse;
  };

  std::vector<Body> bodies_;
  std::vector<Impulse> impulses_;
};

}  // namespace pd::detail
