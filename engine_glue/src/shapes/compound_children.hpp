/// @file
/// The children of a compound that come near another body.
#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <LinearMath/btTransform.h>

#include <vector>

namespace pd::detail {

struct ChildBox {
  btVector3 lower = btVector3(0, 0, 0);
  btVector3 upper = btVector3(0, 0, 0);
};

/// A child of a compound, or the convex body itself (index -1).
struct Child {
  const btCollisionShape* shape;
  btTransform pose;
  int index;
  ChildBox box;      ///< in the world
  int told_as = -1;  ///< the child's number for hosts: of a flat compound's child, that in the compound that holds it
};

/// Of a shape as it stands, with what Bullet adds.
ChildBox box_of(const btCollisionShape& shape, const btTransform& pose);

bool apart(const ChildBox& a, const ChildBox& b, btScalar reach);

/// The children whose boxes come within `reach` of another body's, `box` in the world and its box in the compound's
/// frame, by number, but empty ones. Of a shape that is no compound: itself.
void children_near(const btCollisionObjectWrapper& wrapper, const btCollisionObjectWrapper& other, const ChildBox& box,
                   btScalar reach, std::vector<Child>& children);

/// The children that the host lets meet `other` (`gCompoundChildShapePairCallback`), wherever they are and without
/// their boxes, but empty ones and those whose place is no number. Of a shape that is no compound: itself.
/// @return whether all children are convex
bool all_children(const btCollisionObjectWrapper& wrapper, const btCollisionShape& other, std::vector<Child>& children);

}  // namespace pd::detail
