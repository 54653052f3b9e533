/// @file
/// How the points of a body move at the beginning of a step: rigid bodies, and links of multibodies.
#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>

namespace pd::detail {

/// In the world. A static body does not move.
struct BodyMotion {
  btVector3 velocity = btVector3(0, 0, 0);  ///< of the centre, before the step's forces
  btVector3 gained = btVector3(0, 0, 0);    ///< by the centre, from the step's forces; a link's joints are not asked
  btVector3 turn = btVector3(0, 0, 0);
  btVector3 centre = btVector3(0, 0, 0);
  bool link = false;  ///< of a multibody

  [[nodiscard]] btVector3 velocity_at(const btVector3& place) const { return velocity + turn.cross(place - centre); }
};

/// True if an object is a link of a multibody.
[[nodiscard]] inline bool is_link(const btCollisionObject& object) {
  return (object.getInternalType() & btCollisionObject::CO_FEATHERSTONE_LINK) != 0;
}

/// @param seconds  of the step
/// @return false: an object of which Bullet knows no velocity
[[nodiscard]] bool motion_of(const btCollisionObject& object, btScalar seconds, BodyMotion& out);

}  // namespace pd::detail
