#include "pieces/piece_wrapper.hpp"

#include <BulletCollision/CollisionShapes/btCompoundShape.h>

namespace pd::detail {

bool is_part(const btCollisionObjectWrapper& wrapper) {
  const btCollisionObjectWrapper* parent = wrapper.m_parent;
  if (parent == nullptr || !parent->getCollisionShape()->isCompound()) return false;
  return static_cast<const btCompoundShape*>(parent->getCollisionShape())->getNumChildShapes() > 1 || is_part(*parent);
}

bool is_piece(const btCollisionObjectWrapper& wrapper) {
  const btCollisionObjectWrapper* parent = wrapper.m_parent;
  return parent != nullptr && (parent->getCollisionShape()->isConcave() || is_part(wrapper));
}

}  // namespace pd::detail
