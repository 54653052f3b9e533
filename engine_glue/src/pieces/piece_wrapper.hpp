/// @file
/// Pieces of unions by their wrappers, and how exactly Bullet's scalar places them.
#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <LinearMath/btScalar.h>

#include "pd/union_contact/union_piece.hpp"

namespace pd::detail {

/// Poses are known to half a unit in the last place.
inline constexpr double kPoseRounding = sizeof(btScalar) == sizeof(float) ? 0x1p-21 : 0x1p-46;

[[nodiscard]] inline double seam_slack(double size, double farthest) {
  return pd::seam_slack(size, farthest, kPoseRounding);
}
[[nodiscard]] inline double seam_slack(const PosedShape& a, const PosedShape& b) {
  return pd::seam_slack(a, b, kPoseRounding);
}

/// True if the shape behind the wrapper is one piece of several.
[[nodiscard]] bool is_piece(const btCollisionObjectWrapper& wrapper);
/// True if the shape behind the wrapper is a child of a compound.
[[nodiscard]] bool is_part(const btCollisionObjectWrapper& wrapper);

/// Returns the body that a piece belongs to, or the body itself.
[[nodiscard]] inline const btCollisionObjectWrapper& whole_of(const btCollisionObjectWrapper& wrapper) {
  const btCollisionObjectWrapper* whole = &wrapper;
  while (whole->m_parent != nullptr) whole = whole->m_parent;
  return *whole;
}

}  // namespace pd::detail
