/// @file
/// The motion of bodies that nothing touches: a parabola, and the free turning of a rigid body.
///
/// Bullet adds a step's forces to the velocity and moves by that velocity for all of the step: of a constant
/// acceleration a its way is a h^2 / 2 too long, and a bounce between two such flights loses m a h |v|. It turns a body
/// at one constant angular velocity, which keeps neither energy nor angular momentum of a body of three different
/// moments of inertia. So after Bullet's step bodies in flight, on which no contact, no joint and nothing but a
/// constant force acted, are put where that force takes them:
///
///     x = x0 + v0 h + a h^2 / 2,   v = v0 + a h,   and orientation and angular velocity by `rotate_freely`.
///
/// A part of a step that begins with an impact is the impact first, then a flight: Bullet's restitution is that of the
/// velocities at the end of the part, the forces of the part included, which adds a h to a body that leaves. Bodies
/// that are expected to bounce are therefore stepped without forces, and have them in the flight that follows. Where
/// such a body does not leave all that it touches, the step is made again with its forces in the impact, as Bullet does
/// it.
#pragma once

#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>

#include <vector>

namespace pd::detail {

class FreeFlight {
 public:
  /// How a body was when the step began; by place in the world's array.
  struct Start {
    btTransform pose;
    btVector3 linear;
    btVector3 angular;
    btVector3 acceleration;
    bool touched = false;
    bool flew = false;
    bool turned = false;  ///< its turning is `rotate_freely`, too
  };

  explicit FreeFlight(btDiscreteDynamicsWorld& world) : world_(world) {}

  /// Two bodies that meet at the end of a part. If both have restitution, and one of them touches nothing but the
  /// other, it may bounce off when the next part begins.
  void expect_impact(const btCollisionObject* a, const btCollisionObject* b);
  /// A part begins at the present state.
  void begin_part();
  /// A step of Bullet's begins: notes how bodies are placed and turn.
  void note_start();
  /// Between `applyGravity` and the step: takes the forces of the bodies that are to bounce.
  void take_forces();
  /// After the step.
  void give_back_flags();
  /// Whether bodies without forces did not leave what they touched, after Bullet's step of length `step`: they keep
  /// their forces from here on, and the step is to be made again from where it began.
  bool misjudged(btScalar step);
  /// Moves the bodies that flew. Once, after the step that is not made again.
  void finish(btScalar step);
  /// How a rigid body of the world was when the step began.
  [[nodiscard]] const Start& start_of(const btCollisionObject& object) const {
    return starts_[static_cast<std::size_t>(object.getWorldArrayIndex())];
  }
  /// Where the body would be after `time` of the motion that `finish` gave it, if it flew. @return whether it did.
  bool predict(const btCollisionObject& object, double time, btTransform& pose) const;

 private:
  struct Bounce {
    btRigidBody* body;
    int flags;        ///< of the gyroscopic term, which is part of the flight
    btVector3 force;  ///< taken
  };
  [[nodiscard]] Start& start_of(const btCollisionObject& object) {
    return starts_[static_cast<std::size_t>(object.getWorldArrayIndex())];
  }
  [[nodiscard]] const Bounce* bounce_of(const btCollisionObject* object) const;
  void mark_touched();
  [[nodiscard]] bool leaves(const btPersistentManifold& manifold, btScalar step) const;
  void fly(btRigidBody& body, Start& start, const Bounce* bounce, btScalar step);

  btDiscreteDynamicsWorld& world_;
  std::vector<Start> starts_;
  std::vector<const btCollisionObject*> expected_;  ///< bodies of the impact that the next part begins with
  std::vector<Bounce> bounces_;
};

}  // namespace pd::detail
